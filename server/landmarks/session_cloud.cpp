#include "server/landmarks/session_cloud.hpp"

#include "server/landmarks/fusion.hpp"

#include <cmath>

namespace scanloom::landmarks {

Result<std::vector<CloudPoint>> fuse_captures(std::span<const RobotCapture> captures, double threshold) {
    std::vector<std::vector<Point2>> clouds;
    clouds.reserve(captures.size());
    for (const auto& [robot, capture] : captures) clouds.push_back(in_metres(capture.points));
    const auto fused = fuse(clouds, threshold);
    if (!fused) return fused.error();
    std::vector<CloudPoint> points;
    points.reserve(fused->size());
    for (const auto& point : *fused) {
        const auto& [robot, capture] = captures[point.first];
        const Point2 from_robot = transform(inverse(capture.pose), point.position);
        points.push_back({std::atan2(from_robot.y(), from_robot.x()), from_robot.norm(), point.position, point.clouds,
                          robot, capture.last});
    }
    return points;
}

} // namespace scanloom::landmarks

#include "server/landmarks/session_cloud.hpp"

#include "server/landmarks/fusion.hpp"

#include <cmath>

namespace scanloom::landmarks {

Result<std::vector<CloudPoint>> fuse_captures(std::span<const RobotCapture> captures, double threshold,
                                              const std::function<Result<>()>& ask) {
    std::vector<std::vector<Point2>> clouds;
    clouds.reserve(captures.size());
    for (const auto& one : captures) clouds.push_back(in_metres(one.capture.points));
    const auto fused = fuse(clouds, threshold, ask);
    if (!fused) return fused.error();
    std::vector<CloudPoint> points;
    points.reserve(fused->size());
    for (const auto& point : *fused) {
        const auto& [robot, capture, ended] = captures[point.first];
        const Point2 from_robot = transform(inverse(capture.pose), point.position);
        points.push_back(
            {std::atan2(from_robot.y, from_robot.x), norm(from_robot), point.position, point.clouds, robot, ended});
    }
    return points;
}

} // namespace scanloom::landmarks

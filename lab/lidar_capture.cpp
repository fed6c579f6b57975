#include "lab/lidar_capture.hpp"

#include "common/scan/reading.hpp"
#include "robot_client/sim/laser.hpp"

#include <cmath>

namespace scanloom::lab {
namespace {

constexpr double kTurnPeriod = 0.1; // seconds

/// Calls visit(scan, point in the robot's frame) for each beam with a return.
template <class Visit>
void for_each_point(std::span<const Scan> scans, const Sensor& sensor, Visit&& visit) {
    const ReadingRules rules{sensor.range_min, sensor.range_max, true};
    for (const Scan& scan : scans) {
        const BeamAngles angles = angles_of(scan, sensor);
        for (std::size_t n = 0; n < scan.ranges.size(); ++n) {
            const auto reading = reading_of(scan.ranges[n], rules);
            if (!reading || !reading->is_hit) continue;
            const double angle = beam_angle(angles, n);
            visit(scan, transform(sensor.mount, reading->metres * Point2{std::cos(angle), std::sin(angle)}));
        }
    }
}

} // namespace

LidarCapture take_capture(const robot::World& world, const Pose2& T_map_lidar, std::size_t turns,
                          const std::optional<robot::Noise>& noise, robot::Random& random) {
    LidarCapture capture{robot::find_laser("lidar360").value(), {}};
    for (std::size_t turn = 0; turn < turns; ++turn) {
        Scan scan;
        scan.seq = turn + 1;
        scan.stamp = static_cast<double>(turn) * kTurnPeriod;
        scan.pose = T_map_lidar;
        scan.ranges = robot::sweep(world, capture.sensor, T_map_lidar, noise, random);
        capture.scans.push_back(std::move(scan));
    }
    return capture;
}

std::vector<Point2> points_of(std::span<const Scan> scans, const Sensor& sensor) {
    std::vector<Point2> points;
    for_each_point(scans, sensor, [&](const Scan&, const Point2& point) { points.push_back(point); });
    return points;
}

std::vector<Point2> points_in_map(std::span<const Scan> scans, const Sensor& sensor) {
    std::vector<Point2> points;
    for_each_point(scans, sensor,
                   [&](const Scan& scan, const Point2& point) { points.push_back(transform(scan.pose, point)); });
    return points;
}

} // namespace scanloom::lab

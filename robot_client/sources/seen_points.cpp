#include "robot_client/sources/seen_points.hpp"

#include "common/scan/limits.hpp"
#include "common/scan/reading.hpp"

#include <cmath>

namespace scanloom::robot {

void SeenPoints::add(const Scan& scan, const Sensor& sensor) {
    const Pose2 T_odom_robot = scan.pose.value_or(scan.odometry.value_or(Pose2{}));
    const Pose2 T_odom_sensor = compose(T_odom_robot, sensor.mount);
    const BeamAngles angles = angles_of(scan, sensor);
    const ReadingRules rules{sensor.range_min, sensor.range_max, true};
    for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
        const auto reading = reading_of(scan.ranges[beam], rules);
        if (!reading || !reading->is_hit) continue;
        const double angle = beam_angle(angles, beam);
        const Point2 met = transform(T_odom_sensor, reading->metres * Point2{std::cos(angle), std::sin(angle)});
        if (max_abs(met) <= kCoordinateMax) points_.push_back(in_millimetres(met));
    }
    sum_of_places_ += Point2{T_odom_sensor.x, T_odom_sensor.y};
    ++scans_;
}

std::vector<PointMm> SeenPoints::points() const {
    if (points_.size() <= kViewPointsMax) return points_;
    std::vector<PointMm> some;
    some.reserve(kViewPointsMax);
    for (std::size_t n = 0; n < kViewPointsMax; ++n) some.push_back(points_[n * points_.size() / kViewPointsMax]);
    return some;
}

Point2 SeenPoints::from() const { return sum_of_places_ / static_cast<double>(scans_); }

} // namespace scanloom::robot

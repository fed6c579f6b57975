#include "robot_client/ros/laser_conversion.hpp"

#include "common/scan/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::robot {
namespace {

constexpr double kNanoseconds = 1e9;
constexpr double kOneBeamIncrement = 0.01;                   // radians, of a laser with one beam: any but 0
constexpr double kTiltMax = 15.0 * std::numbers::pi / 180.0; // radians

double range_max_of(const RosLaserScan& scan, const RangeMeaning& meaning) {
    if (meaning.range_max) return *meaning.range_max;
    const double stated = scan.range_max;
    return stated > 0.0 ? std::min(stated, kBelievedRangeMax) : kBelievedRangeMax; // NaN, too, states nothing
}

bool is_above(float range, float range_max) { return std::isfinite(range) && range_max > 0.0F && range > range_max; }

} // namespace

void RangeHabits::add(const RosLaserScan& scan) {
    for (const float range : scan.ranges) {
        has_infinite_ |= std::isinf(range) && range > 0.0F;
        if (!is_above(range, scan.range_max)) continue;
        is_beyond_constant_ &= beyond_.value_or(range) == range;
        beyond_ = range;
    }
}

RangeMeaning RangeHabits::meaning(const RangeOptions& options) const {
    const bool has_marker = !has_infinite_ && beyond_ && is_beyond_constant_;
    RangeMeaning meaning;
    meaning.range_max = options.range_max;
    meaning.is_beyond_no_return = options.is_beyond_no_return.value_or(has_marker);
    meaning.is_zero_no_return = options.is_zero_no_return.value_or(false);
    meaning.no_return = options.no_return.value_or(NoReturn::kFree) == NoReturn::kFree ? kNoReturn : kInvalidRange;
    return meaning;
}

Pose2 planar(const Eigen::Isometry3d& T_a_b) {
    const auto& x_axis = T_a_b.linear().col(0);
    return {T_a_b.translation().x(), T_a_b.translation().y(), std::atan2(x_axis.y(), x_axis.x())};
}

Result<LaserMount> mount_of(const Eigen::Isometry3d& T_robot_laser) {
    const double upright = T_robot_laser.linear()(2, 2); // cosine between the z axes
    if (std::fabs(upright) < std::cos(kTiltMax)) {
        return Error{Errc::kInvalidField, "the laser is tilted by more than 15 degrees"};
    }
    const LaserMount mount{planar(T_robot_laser), upright < 0.0};
    if (std::max(std::fabs(mount.T_robot_laser.x), std::fabs(mount.T_robot_laser.y)) <= kCoordinateMax) return mount;
    return Error{Errc::kInvalidField, "the laser is too far from its robot"};
}

double duration_of(const RosLaserScan& scan) {
    const double gaps = scan.ranges.empty() ? 0.0 : static_cast<double>(scan.ranges.size() - 1);
    const double duration = static_cast<double>(scan.time_increment) * gaps;
    return std::fabs(duration) <= kDurationMax ? duration : 0.0; // NaN, too, states nothing
}

RosTime middle_of(const RosLaserScan& scan, RosTime recorded) {
    const RosTime begun = scan.header.stamp != 0 ? scan.header.stamp : recorded;
    return begun + std::llround(duration_of(scan) / 2.0 * kNanoseconds);
}

Result<> check_usable(const RosLaserScan& scan) {
    const auto count = scan.ranges.size();
    if (count == 0) return Error{Errc::kInvalidField, "no beams"};
    if (count > kBeamsMax) return Error{Errc::kInvalidField, fmt::format("more than {} beams", kBeamsMax)};
    const double increment = scan.angle_increment;
    if (!std::isfinite(scan.angle_min) || !std::isfinite(increment)) {
        return Error{Errc::kInvalidField, "angles that are not finite"};
    }
    if (count > 1 && increment == 0.0) return Error{Errc::kInvalidField, "an angle increment of 0"};
    constexpr double kAngleMax = 4.0 * std::numbers::pi;
    if (std::fabs(scan.angle_min) > kAngleMax || std::fabs(increment) * static_cast<double>(count - 1) > kFullTurn) {
        return Error{Errc::kInvalidField, "beams that span more than a full turn"};
    }
    return {};
}

Sensor sensor_of(const RosLaserScan& scan, const RangeMeaning& meaning, const LaserMount& mount) {
    const double direction = mount.is_upside_down ? -1.0 : 1.0;
    const double increment = scan.ranges.size() == 1 ? kOneBeamIncrement : static_cast<double>(scan.angle_increment);
    Sensor sensor;
    sensor.mount = mount.T_robot_laser;
    sensor.angles = UniformAngles{direction * static_cast<double>(scan.angle_min), direction * increment,
                                  static_cast<std::uint32_t>(scan.ranges.size())};
    sensor.range_max = range_max_of(scan, meaning);
    const double stated = scan.range_min;
    sensor.range_min = stated > 0.0 && stated < sensor.range_max ? stated : 0.0;
    return sensor;
}

Scan scan_of(const RosLaserScan& message, RosTime recorded, const RangeMeaning& meaning) {
    const RangeMm range_max = to_range_mm(range_max_of(message, meaning));
    Scan scan;
    scan.stamp = static_cast<double>(middle_of(message, recorded)) / kNanoseconds;
    scan.duration = duration_of(message);
    scan.ranges.reserve(message.ranges.size());
    for (const float range : message.ranges) {
        RangeMm reading = to_range_mm(static_cast<double>(range));
        if (range == 0.0F && meaning.is_zero_no_return) reading = kNoReturn;
        if (is_above(range, message.range_max)) reading = meaning.is_beyond_no_return ? kNoReturn : kInvalidRange;
        if (reading != kInvalidRange && reading >= range_max) reading = meaning.no_return;
        scan.ranges.push_back(reading);
    }
    return scan;
}

} // namespace scanloom::robot

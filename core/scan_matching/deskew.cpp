#include "core/scan_matching/deskew.hpp"

#include "core/scan_matching/transform2.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

namespace scanloom::scan_matching {
namespace {

constexpr double kMotionSecondsMax = 1.0;
constexpr double kSpeedMax = 10.0;     // metres per second
constexpr double kTurnSpeedMax = 10.0; // radians per second

/// An arc at an even speed.
class Arc {
public:
    explicit Arc(const Motion& motion)
        : yaw_(motion.T_before_now.yaw), seconds_(motion.seconds),
          // The chord of an arc is turned by half of the arc's angle: without that, it is the direction at the start.
          ahead_(Transform2{0.0, 0.0, sin_cos(-0.5 * yaw_)} * Point2{motion.T_before_now.x, motion.T_before_now.y}) {}

    /// Returns T_now_then. The chord's length is taken as that of the arc: in a turn of 0.5 rad, 1 % too short.
    [[nodiscard]] Transform2 after(double seconds) const {
        const double part = seconds / seconds_;
        const Point2 chord = Transform2{0.0, 0.0, sin_cos(0.5 * part * yaw_)} * ahead_;
        return {part * chord.x, part * chord.y, sin_cos(part * yaw_)};
    }

    /// Returns the angle by which the robot turns in this time, radians.
    [[nodiscard]] double turn_after(double seconds) const { return seconds / seconds_ * yaw_; }

private:
    double yaw_;     // radians
    double seconds_; // that the arc takes
    Point2 ahead_;   // metres
};

bool are_monotonic(const BeamAngles& angles) {
    if (std::holds_alternative<UniformAngles>(angles)) return true;
    const std::size_t count = beam_count(angles);
    const bool rise = beam_angle(angles, count - 1) > beam_angle(angles, 0);
    for (std::size_t n = 1; n < count; ++n) {
        const double step = beam_angle(angles, n) - beam_angle(angles, n - 1);
        if (!(rise ? step > 0.0 : step < 0.0)) return false;
    }
    return true;
}

} // namespace

bool can_deskew(const Scan& scan, const Sensor& sensor, const Motion& motion) {
    if (scan.duration == 0.0 || sensor.kind != SensorKind::kLaser || scan.ranges.size() < 2) return false;
    const auto& [x, y, yaw] = motion.T_before_now;
    const double seconds = motion.seconds;
    const bool is_motion = seconds > 0.0 && seconds <= kMotionSecondsMax &&
                           x * x + y * y <= kSpeedMax * kSpeedMax * seconds * seconds &&
                           std::fabs(yaw) <= kTurnSpeedMax * seconds;
    return is_motion && are_monotonic(scan.angles ? *scan.angles : sensor.angles);
}

Scan deskewed(const Scan& scan, const Sensor& sensor, const Motion& motion) {
    const Arc arc(motion);
    const BeamAngles angles = angles_of(scan, sensor);
    const std::size_t count = scan.ranges.size();
    const double first = beam_angle(angles, 0);
    const double span = beam_angle(angles, count - 1) - first;
    const Transform2 T_robot_sensor = transform_of(sensor.mount);
    const Transform2 T_sensor_robot = inverse(T_robot_sensor);
    Scan still = scan;
    still.duration = 0.0;
    ExplicitAngles directions(count);
    for (std::size_t n = 0; n < count; ++n) {
        const double angle = beam_angle(angles, n);
        const double seconds = ((angle - first) / span - 0.5) * scan.duration;
        const double turned = angle + arc.turn_after(seconds);
        const double range = scan.ranges[n] * 1e-3;
        directions[n] = turned;
        if (scan.ranges[n] == kNoReturn || scan.ranges[n] == kInvalidRange || range >= sensor.range_max) continue;
        const auto [s, c] = sin_cos(angle);
        const Transform2 T_sensor_then = T_sensor_robot * arc.after(seconds) * T_robot_sensor;
        const Point2 hit = T_sensor_then * Point2{range * c, range * s};
        // Near the direction of the beam, so that the angles continue over the end of a turn
        const auto [turned_s, turned_c] = sin_cos(turned);
        directions[n] = turned + angle_of(turned_c * hit.y - turned_s * hit.x, turned_c * hit.x + turned_s * hit.y);
        still.ranges[n] = to_range_mm(std::sqrt(hit.x * hit.x + hit.y * hit.y));
    }
    still.angles = std::move(directions);
    return still;
}

} // namespace scanloom::scan_matching

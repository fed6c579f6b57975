#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/sim/random.hpp"
#include "robot_client/sim/world.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace scanloom::robot {

/// What the measurements of a simulated robot suffer from. Standard deviations, but for the uniform one.
struct Noise {
    double range = 0.02;            ///< metres, of each return
    double range_uniform = 0.0;     ///< metres; each return is too long by 0 up to this, all equally likely
    double beam_angle = 0.005;      ///< radians, of each beam's true direction
    double odometry_forward = 0.05; ///< metres for each metre driven, within one control step
    double odometry_turn = 0.05;    ///< radians for each radian turned
    double odometry_drift = 0.02;   ///< radians for each metre driven
};

/// "reference": 684 beams over -90..+90 degrees, 5 m. "lidar360": 360 beams all round, 12 m.
/// "wide": 1081 beams over 270 degrees, 30 m. All stand on the robot's centre and turn ten times a second.
/// Errors  kNotFound: no laser of that name; the message lists those there are.
[[nodiscard]] Result<Sensor> find_laser(std::string_view name);

/// What the laser measures from a place, walkers included. Without noise the readings are exact but for the rounding to
/// millimetres. Beams that meet nothing within range_max are kNoReturn; noise neither makes nor takes returns.
[[nodiscard]] std::vector<RangeMm> sweep(const World& world, const Sensor& laser, const Pose2& T_map_laser,
                                         const std::optional<Noise>& noise, Random& random);

} // namespace scanloom::robot

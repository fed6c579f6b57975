#pragma once

#include "common/scan/scan.hpp"
#include "common/scan/sensor.hpp"
#include "robot_client/sim/random.hpp"

#include <optional>

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

/// The noise of the odometry, made larger or smaller. Pre  scale >= 0.
[[nodiscard]] Noise with_odometry(Noise noise, double scale);

/// What a sensor reads when the first thing in a beam is `range` metres away: kNoReturn at its range_max or beyond.
/// Noise neither makes nor takes returns: beams without one are set aside before, and a noisy return stays within the
/// sensor's limits.
[[nodiscard]] RangeMm reading(double range, const Sensor& sensor, const std::optional<Noise>& noise, Random& random);

/// The direction in which a beam really looks. Draws a number only where there is noise.
[[nodiscard]] double true_direction(double yaw_rad, const std::optional<Noise>& noise, Random& random);

} // namespace scanloom::robot

#pragma once

#include "robot_client/drive/behaviour.hpp"
#include "robot_client/drive/body.hpp"

namespace scanloom::robot {

/// Smallest distance, in metres, that the robot's centre keeps from anything.
inline constexpr double kKeptClear = kBodyRadius + 0.02;

/// Returns how far, in metres, the body can move straight towards `yaw` (radians) before its centre comes nearer than
/// kKeptClear to a point of the scan; infinite if nothing is in the way. Points that are nearer than that already count
/// only where the body would touch them. The third-nearest distance is used, so noise does not stop the robot: any
/// object that is large enough to matter near the robot has many points.
[[nodiscard]] double free_ahead(const Senses& senses, double yaw);

/// Returns the highest speed, in metres per second, from which a robot that drives towards `yaw` (radians) stops in
/// time despite the delay of its scan.
[[nodiscard]] double safe_speed(const Senses& senses, double yaw);

} // namespace scanloom::robot

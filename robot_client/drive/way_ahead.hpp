#pragma once

#include "robot_client/drive/behaviour.hpp"
#include "robot_client/drive/body.hpp"

namespace scanloom::robot {

/// Nearer than this to anything the robot's centre does not go, metres.
inline constexpr double kKeptClear = kBodyRadius + 0.02;

/// Metres that the body can advance straight towards `yaw` before its centre comes nearer than kKeptClear to what the
/// scan shows; infinite where nothing is in the way. What is that near already is in the way only as far as the body
/// would touch it. Points count where a third one agrees, so that noise stops nobody: whatever is large enough to be
/// met near the robot has many.
[[nodiscard]] double free_ahead(const Senses& senses, double yaw);

/// The most speed, metres a second, at which a robot that drives towards `yaw` has stopped in time, however late its
/// scan.
[[nodiscard]] double safe_speed(const Senses& senses, double yaw);

} // namespace scanloom::robot

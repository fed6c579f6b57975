#pragma once

#include "robot_client/drive/behaviour.hpp"

namespace scanloom::robot {

/// Radians per second: the usual limit of the turn rate.
inline constexpr double kEasyTurn = 1.5;

/// Metres per second squared: the deceleration before a stop.
inline constexpr double kEasyBraking = 0.5;

[[nodiscard]] inline Point2 position_of(const Pose2& pose) { return {pose.x, pose.y}; }

/// Returns the direction from one point to another, in radians.
[[nodiscard]] double direction(const Point2& from, const Point2& to);

/// Turns on the spot towards a heading, in radians.
[[nodiscard]] Velocity turn_to(const Pose2& pose, double yaw);
[[nodiscard]] bool is_heading(const Pose2& pose, double yaw);

/// Drives towards a heading (radians) at most at `speed` metres per second. Turns on the spot for large differences and
/// on an arc for small ones, and limits the speed by the obstacles that the scan shows ahead.
[[nodiscard]] Velocity drive_towards(const Senses& senses, double yaw, double speed);

/// Returns the speed from which kEasyBraking stops within a distance in metres.
[[nodiscard]] double braking_speed(double metres);

/// A full turn on the spot, so that the laser scans all directions.
class FullTurn {
public:
    [[nodiscard]] Velocity step(const Pose2& pose);
    [[nodiscard]] bool is_done() const noexcept;

private:
    double turned_ = 0.0; // radians
    bool has_begun_ = false;
    double last_yaw_ = 0.0;
};

} // namespace scanloom::robot

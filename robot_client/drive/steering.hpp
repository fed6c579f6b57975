#pragma once

#include "robot_client/drive/behaviour.hpp"

namespace scanloom::robot {

/// Radians a second: the most that robots turn at when nothing hurries them.
inline constexpr double kEasyTurn = 1.5;

/// Metres a second squared: how robots slow down before they have to stand.
inline constexpr double kEasyBraking = 0.5;

[[nodiscard]] inline Point2 position_of(const Pose2& pose) { return {pose.x, pose.y}; }

/// The direction from one point to another, radians.
[[nodiscard]] double direction(const Point2& from, const Point2& to);

/// Turns on the spot towards a heading.
[[nodiscard]] Velocity turn_to(const Pose2& pose, double yaw);
[[nodiscard]] bool is_heading(const Pose2& pose, double yaw);

/// Towards a heading at `speed` metres a second at most: on the spot where it is far aside, on a bow where it is near,
/// and only as fast as what the scan shows ahead lets it.
[[nodiscard]] Velocity drive_towards(const Senses& senses, double yaw, double speed);

/// The speed from which kEasyBraking stops within some metres.
[[nodiscard]] double braking_speed(double metres);

/// A full turn on the spot, for the laser to see all round.
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

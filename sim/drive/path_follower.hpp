#pragma once

#include "sim/drive/behaviour.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::sim {

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

/// Follows a path of straight segments. It aims at a point of the current segment, a little ahead and never beyond its
/// end, so no corner is cut; at sharp corners it stops and turns. It stops for an obstacle on the path 0.2 m before the
/// distance kKeptClear (nearby_obstacles.hpp). It approaches walls beyond a corner or beyond the end up to kKeptClear.
///
/// Source: for the aim: Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm (CMU-RI-TR-92-01, 1992).
class PathFollower {
public:
    PathFollower() = default; ///< has arrived

    /// @param path  the path, metres in the map frame; it may begin at some distance from the robot
    explicit PathFollower(std::vector<Point2> path);

    [[nodiscard]] Velocity step(const Senses& senses);

    /// Returns whether the robot is within three centimetres of the path's end, or within ten if something keeps it
    /// from coming nearer.
    [[nodiscard]] bool has_arrived() const noexcept { return passed_ + 1 >= path_.size(); }

    /// Returns for how many control steps in a row something ahead has blocked the robot.
    [[nodiscard]] int blocked_steps() const noexcept { return blocked_steps_; }

    /// Returns the remaining length of the path in metres.
    [[nodiscard]] double left(const Point2& position) const;

private:
    void pass_corners(const Point2& position);
    [[nodiscard]] Point2 aim(const Point2& position) const;
    [[nodiscard]] bool stops_at_next_corner() const;

    std::vector<Point2> path_;
    std::size_t passed_ = 0; // points of the path passed
    int blocked_steps_ = 0;
};

} // namespace scanloom::sim

#pragma once

#include "robot_client/drive/behaviour.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::robot {

/// Follows a path of straight segments. It aims at a point of the current segment, a little ahead and never beyond its
/// end, so no corner is cut; at sharp corners it stops and turns. It stops for an obstacle on the path 0.2 m before the
/// distance kKeptClear (way_ahead.hpp). It approaches walls beyond a corner or beyond the end up to kKeptClear.
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

} // namespace scanloom::robot

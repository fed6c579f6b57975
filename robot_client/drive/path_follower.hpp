#pragma once

#include "robot_client/drive/behaviour.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::robot {

/// Drives along a way of straight pieces and keeps to it: it aims at a point of the piece it is on, a little ahead,
/// and never beyond the piece's end, so that no corner is cut; at sharp corners it stops and turns. Before what stands
/// in its way it waits, 0.2 m further off than kKeptClear (way_ahead.hpp); towards the walls beyond a corner or the end
/// it goes on as far as that.
///
/// Source  the aim: Coulter, Implementation of the Pure Pursuit Path Tracking Algorithm (CMU-RI-TR-92-01, 1992).
class PathFollower {
public:
    PathFollower() = default; ///< has arrived

    /// @param way  metres in the map frame; it may begin some way from the robot
    explicit PathFollower(std::vector<Point2> way);

    [[nodiscard]] Velocity step(const Senses& senses);

    /// At the end of the way, to three centimetres; to ten where something keeps it from coming nearer.
    [[nodiscard]] bool has_arrived() const noexcept { return passed_ + 1 >= way_.size(); }

    /// For how many control steps in a row something ahead has kept it from going on.
    [[nodiscard]] int blocked_steps() const noexcept { return blocked_steps_; }

    /// Metres to the end of the way.
    [[nodiscard]] double left(const Point2& position) const;

private:
    void pass_corners(const Point2& position);
    [[nodiscard]] Point2 aim(const Point2& position) const;
    [[nodiscard]] bool stops_at_next_corner() const;

    std::vector<Point2> way_;
    std::size_t passed_ = 0; // of its points
    int blocked_steps_ = 0;
};

} // namespace scanloom::robot

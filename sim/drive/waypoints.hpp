#pragma once

#include "common/geometry/pose2.hpp"
#include "sim/drive/behaviour.hpp"
#include "sim/drive/nearby_obstacles.hpp"
#include "sim/drive/path_follower.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace scanloom::sim {

/// Computes the force of an artificial potential field on a robot, in the map frame. Its length is 1 if only a goal at
/// least one metre away acts.
///
/// The goal attracts: F = -k (x - x_goal), with k = 1 / m, limited to 1.
/// Obstacles within rho_0 = 0.5 m of the body repel, where rho is the distance from the body's rim:
///     F = eta (1 / rho - 1 / rho_0) / rho^2 away from it, the gradient of U = eta / 2 (1 / rho - 1 / rho_0)^2.
/// Each of 24 directions around the robot counts as one obstacle, its nearest, so the number of beams does not matter.
/// Source: Khatib, Real-Time Obstacle Avoidance for Manipulators and Mobile Robots, IJRR 5(1), 1986: the attractive
///         potential 1/2 k (x - x_d)^2, its velocity limited, and the FIRAS function.
[[nodiscard]] Point2 potential_force(const Point2& position, const Point2& goal, std::span<const Point2> obstacles);

/// Where a tour of waypoints begins.
enum class TourStart {
    kFirst,   ///< at the first waypoint
    kNearest, ///< of a round tour: at the nearest one in sight, after a turn; the waypoints before it come at the end
};

/// Drives from waypoint to waypoint by a potential field and makes a full turn at each. A potential field has local
/// minima that hold a robot: a waypoint is given up if the robot comes no nearer to it for 15 seconds, so the drive
/// always ends.
class Waypoints final : public Behaviour {
public:
    /// Returns why a waypoint could not be reached, for people; empty if the reason is not known.
    using Explain = std::function<std::string(const Point2&)>;

    /// @param goals    metres in the map frame
    /// @param explain  called for each waypoint that was given up
    explicit Waypoints(std::vector<Point2> goals, TourStart start = TourStart::kFirst, Explain explain = {});

    [[nodiscard]] Velocity step(const Senses& senses) override;
    [[nodiscard]] bool is_done() const override { return next_ == goals_.size(); }
    [[nodiscard]] bool has_an_end() const override { return true; }
    [[nodiscard]] std::string remarks() const override;

    [[nodiscard]] std::size_t reached() const noexcept { return reached_; }
    [[nodiscard]] std::size_t given_up() const noexcept { return given_up_.size(); }

private:
    [[nodiscard]] Velocity look_around(const Senses& senses);
    void begin_with_nearest(const Point2& position);
    void go_on_to_next();
    [[nodiscard]] Velocity go(const Senses& senses);
    [[nodiscard]] bool has_progress(double distance);

    std::vector<Point2> goals_;
    bool is_looking_around_;
    std::vector<Point2> seen_; // during the turn at the start
    NearObstacles near_;
    std::size_t next_ = 0;
    std::size_t reached_ = 0;
    std::vector<Point2> given_up_;
    Explain explain_;
    bool is_turning_ = false; // at the next waypoint
    FullTurn turn_;
    double nearest_ = 0.0;     // metres from it, so far
    int steps_no_nearer_ = -1; // -1: the drive to it has not begun
};

} // namespace scanloom::sim

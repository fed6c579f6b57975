#pragma once

#include "common/geometry/point_mm.hpp"
#include "sim/noise.hpp"
#include "sim/world.hpp"

#include <cstdint>
#include <vector>

/// Scans of a stationary robot in worlds where a door moves: test data for scan matching and localization.
namespace scanloom::sim {

/// Returns the points of several turns of "lidar360" with noise, in the robot's frame.
[[nodiscard]] std::vector<Point2> standing_capture(const World& world, const Pose2& place, int turns, Random& random);

/// Returns possible doors: closed in the office's doorways and at the hall's cabin, ajar along the room's walls.
[[nodiscard]] std::vector<Box> doors_of(const World& world);

/// Returns the world with one more solid.
[[nodiscard]] World with_door(const World& world, const Box& door);

/// Returns a start for a robot, at least 0.3 m from anything, with a random heading.
[[nodiscard]] Pose2 free_place(const World& world, Random& random);

/// Returns whether the line between two places is free, and the space just behind the second.
[[nodiscard]] bool sees(const World& world, const Pose2& from, const Pose2& to);

inline constexpr int kMappedTurns = 10; ///< turns of the lidar for each view of a map

/// The points observed from one place.
struct StandingView {
    Point2 from{0.0, 0.0};       ///< metres, world frame
    std::vector<PointMm> points; ///< world frame
};

[[nodiscard]] StandingView standing_view(const World& world, const Pose2& place, Random& random,
                                         int turns = kMappedTurns);

/// A world observed from several places, and what a robot observes at another one.
struct MappedWorld {
    std::vector<StandingView> map;
    std::vector<Point2> seen; ///< in the robot's frame
    Pose2 ground_truth;       ///< T_world_robot
};

/// Makes such a world. Each place, including the robot's, is in sight of an earlier one; a door is open in every second
/// view.
/// @param apart_max  largest distance in metres between a place and that earlier one
[[nodiscard]] MappedWorld mapped_world(const World& open, int places, std::uint64_t seed, double apart_max = 3.0);

} // namespace scanloom::sim

#pragma once

#include "common/geometry/point_mm.hpp"
#include "robot_client/sim/random.hpp"
#include "robot_client/sim/world.hpp"

#include <cstdint>
#include <vector>

/// What robots have seen of a world, and one more that asks where it is: what locating is tried on.
namespace scanloom::robot {

inline constexpr int kMappedTurns = 10; ///< of the lidar, for each view of a map

/// What was seen from one place.
struct StandingView {
    Point2 from{0.0, 0.0};       ///< metres, world frame
    std::vector<PointMm> points; ///< world frame
};

[[nodiscard]] StandingView standing_view(const World& world, const Pose2& place, Random& random,
                                         int turns = kMappedTurns);

/// A world that was seen from some places, and what a robot sees in another one.
struct MappedWorld {
    std::vector<StandingView> map;
    std::vector<Point2> seen; ///< in the robot's own frame
    Pose2 truth;              ///< T_world_robot
};

/// Each place, the robot's too, is in sight of an earlier one; a door stood open in every second of them.
/// @param apart_max  metres between a place and that earlier one
[[nodiscard]] MappedWorld mapped_world(const World& open, int places, std::uint64_t seed, double apart_max = 3.0);

} // namespace scanloom::robot

#pragma once

#include "common/geometry/point_mm.hpp"
#include "robot_client/sim/random.hpp"
#include "robot_client/sim/world.hpp"

#include <cstdint>
#include <vector>

/// Test data for localization: a world mapped from several places, and a scan from another place.
namespace scanloom::robot {

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
    Pose2 truth;              ///< T_world_robot
};

/// Makes such a world. Each place, including the robot's, is in sight of an earlier one; a door is open in every second
/// view.
/// @param apart_max  largest distance in metres between a place and that earlier one
[[nodiscard]] MappedWorld mapped_world(const World& open, int places, std::uint64_t seed, double apart_max = 3.0);

} // namespace scanloom::robot

#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point_mm.hpp"
#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"
#include "sim/noise.hpp"
#include "sim/world.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
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

/// Returns the free cells that are at least `clearance_m` metres from occupied cells at all of their points, in the
/// part of the map that has most of them and that a robot with `passage_m` metres around its centre can drive through.
/// Indices into map.cells, increasing; empty if there are none.
[[nodiscard]] std::vector<std::size_t> start_cells(const MapCells& map, double resolution, double clearance_m,
                                                   double passage_m);

/// Converts a ROS map into a world. Occupied cells are solid squares. Rays pass through unknown cells, but a robot does
/// not start there, and their truth is unknown. There is nothing outside the map. A robot starts where half a metre
/// around it is free, or 0.3 m in a map too narrow for that, within the largest part of the map that it can drive
/// through. Time and memory are proportional to the number of cells.
/// Errors: kInvalidField if no place in the map has room for a robot.
[[nodiscard]] Result<World> world_of_map(std::string name, const RosMapDescription& map, const MapCells& cells);

} // namespace scanloom::robot

#pragma once

#include "common/error/error.hpp"
#include "common/ros_map/description.hpp"
#include "common/ros_map/pgm.hpp"
#include "sim/world.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace scanloom::sim {

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

} // namespace scanloom::sim

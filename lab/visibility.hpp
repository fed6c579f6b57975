#pragma once

#include "lab/cell_grid.hpp"

#include "common/scan/sensor.hpp"
#include "robot_client/sim/truth_grid.hpp"

#include <span>

namespace scanloom::lab {

/// Returns the cells that a run could see, with perfect beams in all directions between the laser's first and last
/// beam:
///   free      one of the poses has a line of sight to the cell's centre, within range
///   occupied  one of the poses has a line of sight, within range, to a point of a solid's side in the cell;
///             points are 2 cm or a quarter cell apart, whichever is less
/// Walkers hide nothing.
/// Pre: the laser has uniform angles and is mounted at the robot's centre.
[[nodiscard]] CellMask visible_cells(const robot::World& world, const robot::TruthGrid& truth, const Sensor& laser,
                                     std::span<const Pose2> path, const grid::CellBox& box);

} // namespace scanloom::lab

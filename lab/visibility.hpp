#pragma once

#include "lab/cell_grid.hpp"

#include "common/scan/sensor.hpp"
#include "robot_client/sim/truth_grid.hpp"

#include <span>

namespace scanloom::lab {

/// Which cells a run could see, with perfect beams in all directions between the first and the last of the laser's:
///   free      the cell's centre is in the line of sight of one of the poses, within range
///   occupied  the same for a point of a solid's side that lies in the cell; points are 2 cm apart or a quarter cell
/// Walkers hide nothing.
/// Pre  the laser has uniform angles and stands on the robot's centre.
[[nodiscard]] CellMask visible_cells(const robot::World& world, const robot::TruthGrid& truth, const Sensor& laser,
                                     std::span<const Pose2> path, const grid::CellBox& box);

} // namespace scanloom::lab

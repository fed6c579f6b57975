#pragma once

#include "common/ros_map/pgm.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::robot {

/// Returns the free cells that are at least `clearance_m` metres from occupied cells at all of their points, in the
/// part of the map that has most of them and that a robot with `passage_m` metres around its centre can drive through.
/// Indices into map.cells, increasing; empty if there are none.
[[nodiscard]] std::vector<std::size_t> start_cells(const MapCells& map, double resolution, double clearance_m,
                                                   double passage_m);

} // namespace scanloom::robot

#pragma once

#include "common/ros_map/pgm.hpp"

#include <cstddef>
#include <vector>

namespace scanloom::robot {

/// Free cells from all points of which `clearance_m` metres at least are free of occupied cells, in the part of the map
/// that has most of them and through which a robot with `passage_m` around its centre can drive. Indices into
/// map.cells, rising; empty where there are none.
[[nodiscard]] std::vector<std::size_t> start_cells(const MapCells& map, double resolution, double clearance_m,
                                                   double passage_m);

} // namespace scanloom::robot

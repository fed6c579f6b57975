#pragma once

#include "server/classify/cell_class.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace scanloom::classify {

/// FRONTIER cells that hang together, each 8-adjacent to another one of them: a border of the explored ground.
struct Frontier {
    std::vector<grid::Cell> cells; ///< by rows from the bottom, then from the left
    grid::CellBox bounds;          ///< of the cells
    double centroid_x = 0.0;       ///< mean of the cells' centres, in cells: times cell_size it is metres
    double centroid_y = 0.0;
};

/// All frontiers of at least `size_min` cells, the largest first; those of one size by their first cell, by rows.
/// Cost follows the chunks that have FRONTIER cells; of others it is a glance. Cells are numbered up to 64 cells from
/// the ends of the int32 range: a frontier further out is left out.
/// @param without  cells that count as if they were no FRONTIER; in any order.
[[nodiscard]] std::vector<Frontier> find_frontiers(const ClassView& classes, std::size_t size_min = 1,
                                                   std::span<const grid::Cell> without = {});

} // namespace scanloom::classify

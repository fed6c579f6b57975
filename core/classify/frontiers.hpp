#pragma once

#include "core/classify/cell_class.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace scanloom::classify {

/// A set of frontier cells, each 8-adjacent to another one of the set: a border of the explored area.
struct Frontier {
    std::vector<grid::Cell> cells; ///< by rows from the bottom, then from the left
    grid::CellBox bounds;          ///< of the cells
    double centroid_x = 0.0;       ///< mean of the cells' centres, in cells; multiply by cell_size for metres
    double centroid_y = 0.0;       ///< likewise, in cells
};

/// Returns all frontiers of at least `size_min` cells, the largest first; frontiers of equal size are ordered by their
/// first cell, by rows.
///
/// Only cells at least 64 cells from the ends of the int32 range are considered.
/// @param classes   of the map
/// @param size_min  cells, at least 1
/// @param without   cells that count as if they were not frontier cells, in any order
/// Cost: proportional to the chunks that have frontier cells; other chunks cost only a quick search.
/// Source: Yamauchi, A Frontier-Based Approach for Autonomous Exploration (1997); on a grid, 8-connected.
[[nodiscard]] std::vector<Frontier> find_frontiers(const ClassView& classes, std::size_t size_min = 1,
                                                   std::span<const grid::Cell> without = {});

} // namespace scanloom::classify

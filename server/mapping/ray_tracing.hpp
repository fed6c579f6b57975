#pragma once

#include "server/grid/cell.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace scanloom::mapping {

/// A point in cell units. Cell (i, j) is the square from (i, j) to (i + 1, j + 1).
struct GridPoint {
    double x = 0.0;
    double y = 0.0;
};

/// Returns the cell that contains a point.
[[nodiscard]] inline grid::Cell cell_at(GridPoint point) noexcept {
    return {static_cast<std::int32_t>(std::floor(point.x)), static_cast<std::int32_t>(std::floor(point.y))};
}

/// Calls visit(Cell) for the cells of the straight line between two cells, in order, both ends included.
///
/// Each step along the longer axis visits one cell: the one nearest to the line between the two centres. Of two cells
/// at the same distance, it visits the one further along the shorter axis, so that a line has the same shape for every
/// sign of its direction.
/// Source: Bresenham, Algorithm for Computer Control of a Digital Plotter (1965), with its rounding made explicit.
template <class Visit>
void bresenham(grid::Cell from, grid::Cell to, Visit&& visit) {
    const std::int64_t di = std::int64_t{to.i} - from.i;
    const std::int64_t dj = std::int64_t{to.j} - from.j;
    const std::int64_t along_i = std::abs(di);
    const std::int64_t along_j = std::abs(dj);
    const std::int32_t step_i = di < 0 ? -1 : 1;
    const std::int32_t step_j = dj < 0 ? -1 : 1;
    const bool is_flat = along_i >= along_j;
    const std::int64_t longer = is_flat ? along_i : along_j;
    const std::int64_t shorter = is_flat ? along_j : along_i;

    std::int64_t doubled = longer; // 2 * longer * (offset on the shorter axis + 1/2), minus the steps taken
    grid::Cell cell = from;
    visit(cell);
    for (std::int64_t n = 0; n < longer; ++n) {
        doubled += 2 * shorter;
        const bool aside = doubled >= 2 * longer;
        if (aside) doubled -= 2 * longer;
        if (is_flat || aside) cell.i += step_i;
        if (!is_flat || aside) cell.j += step_j;
        visit(cell);
    }
}

/// Calls visit(Cell) for every cell that a segment crosses, in order, from the cell of `from` to the cell of `to`.
/// Where the segment passes exactly through a corner, it visits the adjacent cell along x.
/// Cost: proportional to the cells visited. Each border is computed from the segment's ends, so that rounding errors do
///       not accumulate.
/// Source: Amanatides, Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (1987).
template <class Visit>
void traverse(GridPoint from, GridPoint to, Visit&& visit) {
    grid::Cell cell = cell_at(from);
    const grid::Cell last = cell_at(to);
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const std::int32_t step_i = last.i < cell.i ? -1 : 1;
    const std::int32_t step_j = last.j < cell.j ? -1 : 1;
    // Position on the segment, 0..1, of the next border; infinite once the last column or row is reached.
    const auto to_column = [&] {
        return cell.i == last.i ? HUGE_VAL : ((step_i > 0 ? cell.i + 1.0 : static_cast<double>(cell.i)) - from.x) / dx;
    };
    const auto to_row = [&] {
        return cell.j == last.j ? HUGE_VAL : ((step_j > 0 ? cell.j + 1.0 : static_cast<double>(cell.j)) - from.y) / dy;
    };
    visit(cell);
    double t_column = to_column();
    double t_row = to_row();
    while (cell != last) {
        if (t_column <= t_row) {
            cell.i += step_i;
            t_column = to_column();
        } else {
            cell.j += step_j;
            t_row = to_row();
        }
        visit(cell);
    }
}

} // namespace scanloom::mapping

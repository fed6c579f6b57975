#pragma once

#include "core/grid/cell.hpp"
#include "core/planning/passability.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>

namespace scanloom::planning {

/// Returns whether no cell on the straight line between two cells is occupied, testing one cell for each step along the
/// line's longer axis.
/// @param from         first cell of the line
/// @param to           last cell of the line
/// @param is_occupied  called with cells between the two, without the two
template <class IsOccupied>
[[nodiscard]] bool sees(grid::Cell from, grid::Cell to, IsOccupied&& is_occupied) {
    const std::int32_t steps = std::max(std::abs(to.i - from.i), std::abs(to.j - from.j));
    for (std::int32_t n = 1; n < steps; ++n) {
        const double part = static_cast<double>(n) / steps;
        const grid::Cell between{from.i + static_cast<std::int32_t>(std::lround(part * (to.i - from.i))),
                                 from.j + static_cast<std::int32_t>(std::lround(part * (to.j - from.j)))};
        if (is_occupied(between)) return false;
    }
    return true;
}

/// Returns the cost of the straight segment between two points, in cells, or nullopt if it touches a cell that cannot
/// be entered, even only at a corner.
///
/// Along the border between two cells the segment costs what the more expensive cell costs.
/// @param passability  decides which cells can be entered, and where a metre costs more
/// @param from         in cells from the window's lower-left corner
/// @param to           in the same unit
/// Precondition: both points are in cells that can be entered.
/// Source: Amanatides, Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (Eurographics 1987).
[[nodiscard]] std::optional<double> cost_of_line(const Passability& passability, const Point2& from, const Point2& to);

/// Returns whether a body stays clear of all obstacles while its centre moves along a straight segment.
///
/// The body is clear if its centre stays further than its radius from the square of every obstacle cell
/// (Passability::obstacles) and, with on_known, from the area outside the window. Exact except for rounding; see
/// kRoundingCells. A body of radius 0 is always clear: callers check the cells that its centre crosses.
/// @param passability  its obstacles and its body radius are used
/// @param from         start of the segment, in cells from the window's lower-left corner
/// @param to           end of the segment, in the same unit; may be equal to `from`
[[nodiscard]] bool keeps_clear(const Passability& passability, const Point2& from, const Point2& to);

} // namespace scanloom::planning

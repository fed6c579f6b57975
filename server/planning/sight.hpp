#pragma once

#include "server/grid/cell.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace scanloom::planning {

/// Returns whether no cell on the straight line between two cells is occupied, testing one cell for each step along the
/// line's longer axis.
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

} // namespace scanloom::planning

#pragma once

#include "server/grid/cell.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace scanloom::planning {

/// Whether no cell between two, one for each step along the longer axis of the straight line, is occupied.
/// @param is_occupied  called with cells between the two
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

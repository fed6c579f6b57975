#pragma once

#include "lab/scoring.hpp"

#include <string_view>
#include <vector>

/// Grids drawn as text: rows from the top, all of equal length.
namespace scanloom::lab {

using Rows = std::vector<std::string_view>;

/// Calls set(value, char) for each character; the lower left character is cell (0, 0).
template <class Value, class Set>
CellGrid<Value> drawn(const Rows& rows, Value blank, Set&& set) {
    const auto height = static_cast<std::int32_t>(rows.size());
    CellGrid<Value> grid({0, 0, static_cast<std::int32_t>(rows.front().size()), height}, blank);
    for_each_cell(grid.box, [&](grid::Cell cell) {
        set(grid.at(cell), rows[static_cast<std::size_t>(height - 1 - cell.j)][static_cast<std::size_t>(cell.i)]);
    });
    return grid;
}

/// '#' occupied, '.' free, any other character unknown.
inline StateGrid map_of(const Rows& rows) {
    return drawn(rows, CellState::kUnknown, [](CellState& cell, char c) {
        if (c == '#') cell = CellState::kOccupied;
        if (c == '.') cell = CellState::kFree;
    });
}

/// '#' solid, '.' free, any other character outside.
inline GroundTruthCells truth_cells_of(const Rows& rows) {
    return drawn(rows, sim::GroundTruth::kOutside, [](sim::GroundTruth& cell, char c) {
        if (c == '#') cell = sim::GroundTruth::kOccupied;
        if (c == '.') cell = sim::GroundTruth::kFree;
    });
}

/// 'x' set, any other character not set.
inline CellMask mask_of(const Rows& rows) {
    return drawn(rows, std::uint8_t{0}, [](std::uint8_t& cell, char c) { cell = c == 'x'; });
}

} // namespace scanloom::lab

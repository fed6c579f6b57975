#pragma once

#include "server/grid/cell.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::lab {

/// A value for each cell of a box, bottom row first.
template <class Value>
struct CellGrid {
    grid::CellBox box;
    std::vector<Value> values;

    CellGrid() = default;
    CellGrid(const grid::CellBox& all, Value value)
        : box(all), values(static_cast<std::size_t>(all.width() * all.height()), value) {}

    [[nodiscard]] bool contains(grid::Cell cell) const noexcept {
        return cell.i >= box.i_begin && cell.i < box.i_end && cell.j >= box.j_begin && cell.j < box.j_end;
    }

    /// Pre: contains(cell).
    [[nodiscard]] Value& at(grid::Cell cell) { return values[index_of(cell)]; }
    [[nodiscard]] const Value& at(grid::Cell cell) const { return values[index_of(cell)]; }

private:
    [[nodiscard]] std::size_t index_of(grid::Cell cell) const noexcept {
        return static_cast<std::size_t>(std::int64_t{cell.j - box.j_begin} * box.width() + (cell.i - box.i_begin));
    }
};

/// A boolean for each cell.
using CellMask = CellGrid<std::uint8_t>;

/// Calls visit(Cell) for every cell of the box, row by row from the bottom.
template <class Visit>
void for_each_cell(const grid::CellBox& box, Visit&& visit) {
    for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
        for (std::int32_t i = box.i_begin; i < box.i_end; ++i) visit(grid::Cell{i, j});
    }
}

} // namespace scanloom::lab

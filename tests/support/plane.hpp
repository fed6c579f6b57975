#pragma once

#include "server/grid/cell.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scanloom::oracle {

/// Cells around the origin as one plain array; asking for others throws.
template <class Value>
class Plane {
public:
    static constexpr std::int32_t kHalf = 1024;

    explicit Plane(Value blank) : cells_(std::size_t{4} * kHalf * kHalf, blank) {}

    [[nodiscard]] Value& operator[](grid::Cell cell) {
        box_.include_row(cell.j, cell.i, cell.i + 1);
        return cells_.at(index_of(cell));
    }
    [[nodiscard]] const Value& at(grid::Cell cell) const { return cells_.at(index_of(cell)); }

    /// Calls visit(Cell, const Value&) for the cells of the smallest box that holds all that were written, and for
    /// `margin` cells around it.
    template <class Visit>
    void for_each(std::int32_t margin, Visit&& visit) const {
        if (box_.empty()) return;
        for (std::int32_t j = box_.j_begin - margin; j < box_.j_end + margin; ++j) {
            for (std::int32_t i = box_.i_begin - margin; i < box_.i_end + margin; ++i)
                visit(grid::Cell{i, j}, at({i, j}));
        }
    }

private:
    [[nodiscard]] static std::size_t index_of(grid::Cell cell) {
        if (cell.i < -kHalf || cell.i >= kHalf || cell.j < -kHalf || cell.j >= kHalf) return SIZE_MAX;
        return static_cast<std::size_t>(cell.j + kHalf) * 2 * kHalf + static_cast<std::size_t>(cell.i + kHalf);
    }

    std::vector<Value> cells_;
    grid::CellBox box_;
};

} // namespace scanloom::oracle

#pragma once

#include "server/planning/bit_grid.hpp"

#include <vector>

namespace scanloom::planning {

/// Set cells side by side: x_begin <= x < x_end.
struct SweepRow {
    std::int32_t y = 0;
    std::int32_t x_begin = 0;
    std::int32_t x_end = 0;

    [[nodiscard]] Spot left() const noexcept { return {x_begin, y}; }
    [[nodiscard]] Spot right() const noexcept { return {x_end - 1, y}; }

    friend bool operator==(const SweepRow&, const SweepRow&) = default;
};

/// Rows one above the other that can be swept to and fro without a choice.
using SweepBlock = std::vector<SweepRow>;

/// Parts ground into blocks: rows `spacing` cells apart, the first at the lowest set cell, split where a cell is not
/// set. A block ends where a row has several neighbours above or below it, or shares one.
/// Source  the cellular decomposition of Choset, Pignon, Coverage Path Planning: The Boustrophedon Cellular
///         Decomposition (1998), on rows.
[[nodiscard]] std::vector<SweepBlock> sweep_blocks(const BitGrid& ground, std::int32_t spacing);

} // namespace scanloom::planning

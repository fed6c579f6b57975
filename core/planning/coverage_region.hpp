#pragma once

#include "core/planning/bit_grid.hpp"
#include "core/planning/passability.hpp"

#include <span>
#include <vector>

namespace scanloom::planning {

inline constexpr std::size_t kRegionCornersMax = 4096; ///< corners of a region's polygon

/// Returns the window's cells whose centres are inside a polygon. Where the polygon crosses itself, inside and outside
/// alternate (even-odd rule).
/// @param passability  its window and cell size are used
/// @param corners      metres, map frame, clockwise or counter-clockwise; the last one is connected to the first
/// Errors: kInvalidField for fewer than 3 or more than kRegionCornersMax corners, or for a corner that is not finite.
[[nodiscard]] Result<BitGrid> cells_inside(const Passability& passability, std::span<const Point2> corners);

/// Adjacent set cells of a row: x_begin <= x < x_end.
struct SweepRow {
    std::int32_t y = 0;       ///< row of the window
    std::int32_t x_begin = 0; ///< first column
    std::int32_t x_end = 0;   ///< column after the last one

    /// Returns the leftmost cell.
    [[nodiscard]] Spot left() const noexcept { return {x_begin, y}; }
    /// Returns the rightmost cell.
    [[nodiscard]] Spot right() const noexcept { return {x_end - 1, y}; }

    friend bool operator==(const SweepRow&, const SweepRow&) = default;
};

/// Adjacent rows that can be swept one after the other, with no choice between several neighbours.
using SweepBlock = std::vector<SweepRow>;

/// Divides ground into blocks of rows.
///
/// Rows are `spacing` cells apart, the first at the lowest set cell, and are split at clear cells. A block ends where a
/// row has several neighbours above or below it, or shares a neighbour with another row.
/// @param ground   cells to cover
/// @param spacing  cells from row to row, at least 1
/// Source: the cellular decomposition of Choset, Pignon, Coverage Path Planning: The Boustrophedon Cellular
///     Decomposition (1998), applied to rows.
[[nodiscard]] std::vector<SweepBlock> sweep_blocks(const BitGrid& ground, std::int32_t spacing);

} // namespace scanloom::planning

#pragma once

#include "server/grid/chunk.hpp"

#include <array>
#include <cstdint>

namespace scanloom::grid {

/// One bit per cell of a chunk: bit i of row j is the cell (i, j) of the chunk, so that 64 cells are handled at once.
using BitPlane = std::array<std::uint64_t, kChunkSide>;

/// Returns the bit of a cell within its row.
[[nodiscard]] constexpr std::uint64_t bit_of(Cell cell) noexcept {
    return std::uint64_t{1} << (cell.i & (kChunkSide - 1));
}

/// Returns the index of a cell's row in a plane of its chunk.
[[nodiscard]] constexpr std::size_t row_of(Cell cell) noexcept {
    return static_cast<std::size_t>(cell.j & (kChunkSide - 1));
}

[[nodiscard]] constexpr bool is_set(const BitPlane& plane, Cell cell) noexcept {
    return (plane[row_of(cell)] & bit_of(cell)) != 0;
}

constexpr void set(BitPlane& plane, Cell cell, bool value) noexcept {
    plane[row_of(cell)] = (plane[row_of(cell)] & ~bit_of(cell)) | (value ? bit_of(cell) : 0);
}

} // namespace scanloom::grid

#pragma once

#include "core/grid/cell.hpp"
#include "core/grid/item_ref.hpp"

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>

namespace scanloom::grid {

inline constexpr std::int32_t kChunkBits = 6; ///< bits of a cell's index within its chunk, along each axis
inline constexpr std::int32_t kChunkSide = 1 << kChunkBits; ///< cells

/// The key of a chunk. Chunk (ci, cj) contains the cells with i in [64 ci, 64 ci + 64) and j in [64 cj, 64 cj + 64).
/// Keys are ordered by rows from the bottom, then from the left.
struct ChunkKey {
    std::int32_t cj = 0; ///< row of chunks
    std::int32_t ci = 0; ///< column of chunks

    friend auto operator<=>(const ChunkKey&, const ChunkKey&) = default;
};

/// Returns the chunk that contains a cell.
[[nodiscard]] constexpr ChunkKey chunk_of(Cell cell) noexcept {
    return {.cj = cell.j >> kChunkBits, .ci = cell.i >> kChunkBits};
}

/// Returns a cell's index among the 4096 of its chunk: row by row, the bottom row first.
[[nodiscard]] constexpr std::size_t index_in_chunk(Cell cell) noexcept {
    return static_cast<std::size_t>((cell.j & (kChunkSide - 1)) << kChunkBits | (cell.i & (kChunkSide - 1)));
}

/// 64 x 64 cells of one layer, the bottom row first.
template <class CellValue>
struct Chunk : TreeItem {
    std::array<CellValue, std::size_t{kChunkSide} * kChunkSide> cells; ///< index_in_chunk() is the index of a cell

    /// Returns the value of a cell. Only the cell's position within its chunk counts.
    [[nodiscard]] CellValue& at(Cell cell) noexcept { return cells[index_in_chunk(cell)]; }
    /// Returns the value of a cell. Only the cell's position within its chunk counts.
    [[nodiscard]] const CellValue& at(Cell cell) const noexcept { return cells[index_in_chunk(cell)]; }
};

/// The chunks with ci_begin <= ci < ci_end and cj_begin <= cj < cj_end; all chunks by default.
struct ChunkBox {
    std::int64_t ci_begin = std::int64_t{std::numeric_limits<std::int32_t>::min()};   ///< first column
    std::int64_t cj_begin = std::int64_t{std::numeric_limits<std::int32_t>::min()};   ///< first row
    std::int64_t ci_end = std::int64_t{std::numeric_limits<std::int32_t>::max()} + 1; ///< column after the last one
    std::int64_t cj_end = std::int64_t{std::numeric_limits<std::int32_t>::max()} + 1; ///< row after the last one

    /// Returns whether all chunks of `other`, which is not empty, are in this box.
    [[nodiscard]] bool contains(const ChunkBox& other) const noexcept {
        return ci_begin <= other.ci_begin && other.ci_end <= ci_end && cj_begin <= other.cj_begin &&
               other.cj_end <= cj_end;
    }
    /// Returns whether any chunk is in both boxes; neither is empty.
    [[nodiscard]] bool intersects(const ChunkBox& other) const noexcept {
        return ci_begin < other.ci_end && other.ci_begin < ci_end && cj_begin < other.cj_end && other.cj_begin < cj_end;
    }
};

/// Returns the box of chunks that contain any cell of a box.
[[nodiscard]] inline ChunkBox chunks_of(const CellBox& box) noexcept {
    if (box.empty()) return {0, 0, 0, 0};
    const auto begin = chunk_of({box.i_begin, box.j_begin});
    const auto last = chunk_of({box.i_end - 1, box.j_end - 1});
    return {begin.ci, begin.cj, std::int64_t{last.ci} + 1, std::int64_t{last.cj} + 1};
}

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

/// Returns whether the bit of a cell is set in the plane of its chunk.
[[nodiscard]] constexpr bool is_set(const BitPlane& plane, Cell cell) noexcept {
    return (plane[row_of(cell)] & bit_of(cell)) != 0;
}

/// Sets or clears the bit of a cell in the plane of its chunk.
constexpr void set(BitPlane& plane, Cell cell, bool value) noexcept {
    plane[row_of(cell)] = (plane[row_of(cell)] & ~bit_of(cell)) | (value ? bit_of(cell) : 0);
}

} // namespace scanloom::grid

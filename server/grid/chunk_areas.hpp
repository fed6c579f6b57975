#pragma once

#include "server/grid/chunk.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace scanloom::grid {

/// The most chunks from a chunk to others of its area.
inline constexpr std::int32_t kAreaReachMax = 16;

/// Chunks whose cells, and those of chunks within reach of them, have int32 numbers.
inline constexpr std::int64_t kNumberedChunkEnd =
    std::int64_t{std::numeric_limits<std::int32_t>::max()} / kChunkSide - kAreaReachMax - 1;
inline constexpr ChunkBox kNumberedChunks{-kNumberedChunkEnd, -kNumberedChunkEnd, kNumberedChunkEnd, kNumberedChunkEnd};

/// The cells of a chunk. Pre  it is one of kNumberedChunks.
[[nodiscard]] CellBox box_of(ChunkKey key) noexcept;

/// The box with so many chunks more on every side.
[[nodiscard]] CellBox grown(const CellBox& box, std::int32_t chunks) noexcept;

/// Chunks, divided into areas: those that are within reach of one another, from one to the next, are one. Each area is
/// taken once, into a box that grows to hold it.
/// Thread  one.
class ChunkAreas {
public:
    /// @param chunks  of kNumberedChunks, each once
    /// @param reach  from a chunk to others of its area, 1..kAreaReachMax, along each axis; 1: they touch
    ChunkAreas(std::vector<ChunkKey> chunks, std::int32_t reach);

    /// Sorted.
    [[nodiscard]] const std::vector<ChunkKey>& chunks() const noexcept { return chunks_; }
    [[nodiscard]] std::int64_t taken_count() const noexcept { return taken_count_; }

    void take_all(CellBox& box);

    /// The area of a chunk, or those within reach of a chunk that is none of these.
    void take_around(ChunkKey key, CellBox& box);

    /// Grows the box by a chunk on every side, with whatever area would come within reach of it.
    void take_touched(CellBox& box);

private:
    void take_neighbours(ChunkKey key, CellBox& box);

    std::int32_t reach_;
    std::vector<ChunkKey> chunks_;
    std::vector<bool> taken_;
    std::int64_t taken_count_ = 0;
    std::vector<ChunkKey> open_; // taken, but not their neighbours yet
};

} // namespace scanloom::grid

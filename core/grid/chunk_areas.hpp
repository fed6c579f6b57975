#pragma once

#include "core/grid/chunk.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace scanloom::grid {

/// The largest reach of ChunkAreas, in chunks.
inline constexpr std::int32_t kAreaReachMax = 16;

/// The chunks whose cells, and the cells of chunks within reach of them, have int32 indices.
inline constexpr std::int64_t kNumberedChunkEnd =
    std::int64_t{std::numeric_limits<std::int32_t>::max()} / kChunkSide - kAreaReachMax - 1;
/// The chunks on which areas are computed: the cells of all chunks within reach of them have int32 indices.
inline constexpr ChunkBox kNumberedChunks{-kNumberedChunkEnd, -kNumberedChunkEnd, kNumberedChunkEnd, kNumberedChunkEnd};

/// Returns the box of a chunk's cells.
/// @param key  one of kNumberedChunks
[[nodiscard]] CellBox box_of(ChunkKey key) noexcept;

/// Returns the box extended by a number of chunks on every side.
[[nodiscard]] CellBox grown(const CellBox& box, std::int32_t chunks) noexcept;

/// Divides chunks into areas. Two chunks belong to the same area if a sequence of chunks connects them in which each is
/// within reach of the next.
///
/// Each area is taken once: the take functions extend a box to contain areas that were not taken before.
/// Threads: one thread only.
class ChunkAreas {
public:
    /// @param chunks  chunks of kNumberedChunks, each once, in any order
    /// @param reach  greatest distance, in chunks along each axis, between neighbours in an area, 1..kAreaReachMax; 1:
    ///               neighbours touch
    ChunkAreas(std::vector<ChunkKey> chunks, std::int32_t reach);

    /// Returns all chunks, sorted.
    [[nodiscard]] const std::vector<ChunkKey>& chunks() const noexcept { return chunks_; }
    /// Returns the number of chunks that have been taken.
    [[nodiscard]] std::int64_t taken_count() const noexcept { return taken_count_; }

    /// Takes all areas and extends the box to contain them.
    /// @param box  extended; may be empty before
    void take_all(CellBox& box);

    /// Takes the area of a chunk and extends the box to contain it. If the chunk is not one of these chunks, takes the
    /// areas within reach of it.
    /// @param key  of any chunk
    /// @param box  extended; may be empty before
    void take_around(ChunkKey key, CellBox& box);

    /// Takes every area within reach of the box extended by one chunk, and extends the box to contain these areas and
    /// one more chunk on every side. Repeats for areas that come within reach as the box grows.
    /// @param box  extended; not empty before
    void take_touched(CellBox& box);

private:
    void take_neighbours(ChunkKey key, CellBox& box);

    std::int32_t reach_;
    std::vector<ChunkKey> chunks_;
    std::vector<bool> taken_;
    std::int64_t taken_count_ = 0;
    std::vector<ChunkKey> open_; // taken, but their neighbours are not yet
};

} // namespace scanloom::grid

#pragma once

#include "server/grid/bit_plane.hpp"
#include "server/mapping/laser_chunk.hpp"

#include <cstdint>
#include <map>

namespace scanloom::mapping {

/// The cells of one chunk that rays passed or hit.
struct ChunkMarks {
    grid::BitPlane passed{}; ///< by a ray, before its hit
    grid::BitPlane hit{};
};

/// The cells that the rays of a scan pass and hit. A cell counts once, however many rays cross it, and a hit takes
/// precedence over a pass.
/// Memory: two bits per cell of the chunks that rays touch.
class ScanMarks {
public:
    void pass(grid::Cell cell) { mark(cell, &ChunkMarks::passed); }
    void hit(grid::Cell cell) { mark(cell, &ChunkMarks::hit); }

    /// Returns the marks of all chunks that have any.
    [[nodiscard]] const std::map<grid::ChunkKey, ChunkMarks>& chunks() const noexcept { return chunks_; }

    /// Removes and returns the marks of the first chunk.
    /// Precondition: chunks() is not empty.
    [[nodiscard]] auto take_first() {
        current_ = nullptr;
        return chunks_.extract(chunks_.begin());
    }

private:
    void mark(grid::Cell cell, grid::BitPlane ChunkMarks::*kind) {
        const grid::ChunkKey key = grid::chunk_of(cell);
        if (current_ == nullptr || key != current_key_) { // neighbours on a ray mostly share a chunk
            current_ = &chunks_[key];
            current_key_ = key;
        }
        const auto row = static_cast<std::size_t>(cell.j & (grid::kChunkSide - 1));
        (current_->*kind)[row] |= std::uint64_t{1} << (cell.i & (grid::kChunkSide - 1));
    }

    std::map<grid::ChunkKey, ChunkMarks> chunks_;
    grid::ChunkKey current_key_;
    ChunkMarks* current_ = nullptr;
};

/// Returns the verdicts of a chunk's marks; a hit takes precedence over a pass.
[[nodiscard]] inline ChunkVerdicts verdicts_of(const ChunkMarks& marks) noexcept {
    ChunkVerdicts verdicts{.occupied = marks.hit};
    for (std::size_t j = 0; j < marks.passed.size(); ++j) {
        verdicts.free[j] = marks.passed[j] & ~marks.hit[j];
        verdicts.free_rows |= std::uint64_t{verdicts.free[j] != 0} << j;
        verdicts.occupied_rows |= std::uint64_t{marks.hit[j] != 0} << j;
    }
    return verdicts;
}

} // namespace scanloom::mapping

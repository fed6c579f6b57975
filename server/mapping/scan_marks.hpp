#pragma once

#include "server/grid/chunk.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <map>

namespace scanloom::mapping {

/// What rays say of the cells of one chunk, a bit a cell, row by row: bit i of row j is cell (i, j) of the chunk.
struct ChunkMarks {
    std::array<std::uint64_t, grid::kChunkSide> passed{}; ///< by a ray, before its hit
    std::array<std::uint64_t, grid::kChunkSide> hit{};
};

/// The cells that the rays of a scan pass and hit, each once however many rays say so; a hit beats a pass.
/// Memory  two bits a cell of the chunks that were touched.
class ScanMarks {
public:
    void pass(grid::Cell cell) { mark(cell, &ChunkMarks::passed); }
    void hit(grid::Cell cell) { mark(cell, &ChunkMarks::hit); }

    [[nodiscard]] const std::map<grid::ChunkKey, ChunkMarks>& chunks() const noexcept { return chunks_; }

    /// Takes out the marks of the first chunk. Pre: there is one.
    [[nodiscard]] auto take_first() {
        current_ = nullptr;
        return chunks_.extract(chunks_.begin());
    }

private:
    void mark(grid::Cell cell, std::array<std::uint64_t, grid::kChunkSide> ChunkMarks::*kind) {
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

/// Calls run(begin, end) for each run of bits that are set, from the lowest.
template <class Run>
void for_each_run(std::uint64_t bits, Run&& run) {
    int base = 0;
    while (bits != 0) {
        const int begin = std::countr_zero(bits);
        bits >>= begin;
        const int length = std::countr_one(bits);
        run(base + begin, base + begin + length);
        if (length == 64) return;
        bits >>= length;
        base += begin + length;
    }
}

} // namespace scanloom::mapping

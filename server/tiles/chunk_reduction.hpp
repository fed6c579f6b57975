#pragma once

#include "core/mapping/snapshot.hpp"
#include "server/tiles/layer_style.hpp"

#include <array>
#include <cstddef>

namespace scanloom::tiles {

/// A chunk at a coarser scale. The first side * side saliences are in use, bottom row first.
struct ReducedChunk {
    std::array<Salience, std::size_t{grid::kChunkSide} * grid::kChunkSide> pixels;
    std::int32_t side = 0; ///< pixels, 64 .. 1

    [[nodiscard]] Salience at(std::int32_t column, std::int32_t row) const noexcept {
        return pixels[static_cast<std::size_t>(row * side + column)];
    }
};

/// Reduces a chunk to the greatest salience of each block of cells.
/// @param block  side of a block in cells; a power of two, 1..64
[[nodiscard]] ReducedChunk reduce(const mapping::ChunkCells<mapping::LogOdds>& cells, std::int32_t block);
[[nodiscard]] ReducedChunk reduce(const mapping::ChunkCells<mapping::HimmCount>& cells, std::int32_t block);
[[nodiscard]] ReducedChunk reduce(const mapping::ChunkCells<classify::CellClass>& cells, std::int32_t block);

} // namespace scanloom::tiles

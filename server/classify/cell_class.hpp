#pragma once

#include "server/grid/chunk_tree.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace scanloom::classify {

/// What the evidence so far says of a cell. Depends on the order of the evidence: see Hysteresis.
enum class OccType : std::uint8_t { kUnexplored = 0, kFree = 1, kOccupied = 2 };

/// The occ_types of one chunk, bottom row first.
using OccPlane = std::array<OccType, std::size_t{grid::kChunkSide} * grid::kChunkSide>;

/// What a cell means to whoever drives: its OccType, told apart by its neighbours. The numbers are those of tiles.
///   frontier  unexplored, and one of the 8 cells around it is free
///   danger    free, and an occupied cell is near: see ClassLayer
enum class CellClass : std::uint8_t { kUnexplored = 0, kFree = 1, kOccupied = 2, kFrontier = 3, kDanger = 4 };

using ClassChunk = grid::Chunk<CellClass>;
using ClassView = grid::ChunkView<ClassChunk>;

[[nodiscard]] inline CellClass class_at(const ClassView& view, grid::Cell cell) noexcept {
    const auto* chunk = view.find(grid::chunk_of(cell));
    return chunk == nullptr ? CellClass::kUnexplored : chunk->at(cell);
}

} // namespace scanloom::classify

#pragma once

#include "core/mapping/snapshot.hpp"

/// Access to the cells of a snapshot, one by one.
namespace scanloom::testing_support {

inline mapping::LogOdds occupancy_at(const mapping::Snapshot& snapshot, grid::Cell cell) {
    const auto* chunk = snapshot.laser.find(grid::chunk_of(cell));
    return chunk == nullptr ? mapping::kUnknownLogOdds : chunk->occupancy[grid::index_in_chunk(cell)];
}

inline mapping::HimmCount himm_at(const mapping::Snapshot& snapshot, grid::Cell cell) {
    const auto* chunk = snapshot.laser.find(grid::chunk_of(cell));
    return chunk == nullptr ? mapping::kUnseenHimm : chunk->himm[grid::index_in_chunk(cell)];
}

inline mapping::LogOdds sonar_at(const mapping::Snapshot& snapshot, grid::Cell cell) {
    const auto* chunk = snapshot.sonar.find(grid::chunk_of(cell));
    return chunk == nullptr ? mapping::kUnknownLogOdds : chunk->cells[grid::index_in_chunk(cell)];
}

inline classify::CellClass class_at(const mapping::Snapshot& snapshot, grid::Cell cell) {
    const auto* chunk = snapshot.classes.find(grid::chunk_of(cell));
    return chunk == nullptr ? classify::CellClass::kUnexplored : chunk->at(cell);
}

/// Calls visit(Cell, LaserChunk, index in its arrays) for every cell of the laser chunks.
template <class Visit>
void for_each_laser_cell(const mapping::Snapshot& snapshot, Visit&& visit) {
    snapshot.laser.visit({}, 0, [&](grid::ChunkKey key, const mapping::LaserChunk& chunk) {
        for (std::int32_t n = 0; n < 64 * 64; ++n) {
            visit(grid::Cell{64 * key.ci + n % 64, 64 * key.cj + n / 64}, chunk, static_cast<std::size_t>(n));
        }
    });
}

} // namespace scanloom::testing_support

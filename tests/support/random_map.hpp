#pragma once

#include "core/mapping/snapshot.hpp"

#include <array>
#include <map>
#include <random>
#include <vector>

namespace scanloom::testing_support {

using Cells = std::array<mapping::LogOdds, std::size_t{grid::kChunkSide} * grid::kChunkSide>;

/// A map built by hand: set cells, then take a snapshot.
class HandMadeMap {
public:
    void set(grid::Cell cell, mapping::LogOdds value) {
        const auto key = grid::chunk_of(cell);
        auto [at, made] = chunks_.try_emplace(key);
        if (made) at->second.fill(mapping::kUnknownLogOdds);
        at->second[grid::index_in_chunk(cell)] = value;
        bounds_.include_row(cell.j, cell.i, cell.i + 1);
    }

    /// All chunks have this revision.
    [[nodiscard]] mapping::Snapshot snapshot(Revision revision = 1, mapping::MapConfig config = {}) const {
        mapping::LaserLayers layers{config};
        for (const auto& [key, cells] : chunks_) layers.restore(key, revision).occupancy = cells;
        return {.revision = revision,
                .config = config,
                .bounds = {.laser = {.occupancy = bounds_}},
                .laser = layers.snapshot()};
    }

    [[nodiscard]] const std::map<grid::ChunkKey, Cells>& chunks() const { return chunks_; }

private:
    std::map<grid::ChunkKey, Cells> chunks_;
    grid::CellBox bounds_;
};

/// Returns an unknown, free, occupied or nearly undecided cell. Observed cells are sparse, so that coarse pixels
/// differ.
inline mapping::LogOdds random_cell(std::mt19937& random) {
    const auto kind = random() % 100;
    if (kind < 55) return mapping::kUnknownLogOdds;
    if (kind < 75) return static_cast<mapping::LogOdds>(-static_cast<int>(random() % 14146));
    if (kind < 99) return static_cast<mapping::LogOdds>(static_cast<int>(random() % 400) - 200);
    return static_cast<mapping::LogOdds>(random() % 14146);
}

/// Returns chunks around the origin, at the corners and edges of the tiled square, beyond it, and scattered.
inline std::vector<grid::ChunkKey> scattered_chunks(std::mt19937& random) {
    std::vector<grid::ChunkKey> keys;
    for (std::int32_t cj = -5; cj < 5; ++cj) {
        for (std::int32_t ci = -5; ci < 5; ++ci) keys.push_back({cj, ci});
    }
    for (const std::int32_t cj : {-1025, -1024, 1023, 1024}) {
        for (const std::int32_t ci : {-1025, -1024, 0, 1023, 1024}) keys.push_back({cj, ci});
    }
    for (int n = 0; n < 60; ++n) {
        keys.push_back(
            {static_cast<std::int32_t>(random() % 2048) - 1024, static_cast<std::int32_t>(random() % 2048) - 1024});
    }
    return keys;
}

inline HandMadeMap random_map(unsigned seed) {
    std::mt19937 random(seed);
    HandMadeMap map;
    for (const auto& key : scattered_chunks(random)) {
        const unsigned keep_one_in = random() % 2 == 0 ? 1 : 1000; // so that whole chunks also differ
        for (std::int32_t j = 0; j < grid::kChunkSide; ++j) {
            for (std::int32_t i = 0; i < grid::kChunkSide; ++i) {
                const auto value = random_cell(random);
                if (value == mapping::kUnknownLogOdds || random() % keep_one_in != 0) continue;
                map.set({key.ci * grid::kChunkSide + i, key.cj * grid::kChunkSide + j}, value);
            }
        }
    }
    return map;
}

} // namespace scanloom::testing_support

#pragma once

#include "core/mapping/layer.hpp"
#include "core/mapping/snapshot.hpp"
#include "tests/support/snapshot_cells.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <unordered_map>

/// The contents of tiles as the contract defines them: the code of each cell, and which of several cells a pixel shows.
namespace scanloom::oracle {

using Code = std::uint8_t;

inline Code code_of(mapping::LogOdds l) {
    if (l == mapping::kUnknownLogOdds) return 255;
    return static_cast<Code>(std::lround(100.0 / (1.0 + std::exp(-l / 2048.0))));
}
inline Code code_of(mapping::HimmCount count) { return count; } // in the layer, 255 also means unseen
inline Code code_of(classify::CellClass value) { return static_cast<Code>(value); }

/// Returns the code of a cell that was never observed.
inline Code unknown_code(mapping::Layer layer) { return layer == mapping::Layer::kClassification ? 0 : 255; }

/// The rule for pixels that cover several cells, as the contract states it.
class PixelOracle {
public:
    explicit PixelOracle(mapping::Layer layer) : layer_(layer) {}

    void add(Code code) {
        if (code == unknown_code(layer_)) return;
        highest_ = is_known_ ? std::max(highest_, code) : code;
        lowest_ = is_known_ ? std::min(lowest_, code) : code;
        is_known_ = true;
        has_danger_ |= code == 4;
        has_occupied_ |= code == 2;
    }

    [[nodiscard]] Code code() const {
        if (!is_known_) return unknown_code(layer_);
        switch (layer_) {
        case mapping::Layer::kHimm: return highest_;
        case mapping::Layer::kClassification: // occupied, danger, frontier, free
            return has_occupied_ ? 2 : has_danger_ ? 4 : highest_;
        default: return highest_ > 50 ? highest_ : lowest_; // the child furthest above 0.5, else the lowest known one
        }
    }

private:
    mapping::Layer layer_;
    bool is_known_ = false;
    bool has_danger_ = false;
    bool has_occupied_ = false;
    Code highest_ = 0;
    Code lowest_ = 0;
};

inline Code code_at(const mapping::Snapshot& snapshot, mapping::Layer layer, grid::Cell cell) {
    switch (layer) {
    case mapping::Layer::kHimm: return code_of(testing_support::himm_at(snapshot, cell));
    case mapping::Layer::kSonar: return code_of(testing_support::sonar_at(snapshot, cell));
    case mapping::Layer::kClassification: return code_of(testing_support::class_at(snapshot, cell));
    case mapping::Layer::kOccupancy: break;
    }
    return code_of(testing_support::occupancy_at(snapshot, cell));
}

/// Calls visit(i, j, code) for each cell of a layer's chunks.
template <class Visit>
void for_each_code(const mapping::Snapshot& snapshot, mapping::Layer layer, Visit&& visit) {
    const auto walk = [&](grid::ChunkKey key, const auto& cells) {
        for (std::int32_t n = 0; n < 4096; ++n) {
            visit(64 * key.ci + n % 64, 64 * key.cj + n / 64, code_of(cells[static_cast<std::size_t>(n)]));
        }
    };
    switch (layer) {
    case mapping::Layer::kOccupancy:
        snapshot.laser.visit({}, 0, [&](grid::ChunkKey key, const auto& chunk) { walk(key, chunk.occupancy); });
        break;
    case mapping::Layer::kHimm:
        snapshot.laser.visit({}, 0, [&](grid::ChunkKey key, const auto& chunk) { walk(key, chunk.himm); });
        break;
    case mapping::Layer::kSonar:
        snapshot.sonar.visit({}, 0, [&](grid::ChunkKey key, const auto& chunk) { walk(key, chunk.cells); });
        break;
    case mapping::Layer::kClassification:
        snapshot.classes.visit({}, 0, [&](grid::ChunkKey key, const auto& chunk) { walk(key, chunk.cells); });
        break;
    }
}

using TilePlace = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>; // zoom, x, y
using TilePixels = std::unordered_map<int, PixelOracle>;                   // by 256 py + px
using Pyramid = std::map<TilePlace, TilePixels>;

/// Assigns each cell to its pixel at every zoom, as the contract defines.
inline Pyramid pyramid_of(const mapping::Snapshot& snapshot, mapping::Layer layer) {
    Pyramid pyramid;
    for_each_code(snapshot, layer, [&](std::int32_t i, std::int32_t j, Code code) {
        if (i < -65536 || i > 65535 || j < -65536 || j > 65535) return;
        for (std::uint32_t zoom = 0; zoom <= 9; ++zoom) {
            const int column = (i + 65536) >> (9 - zoom);
            const int row = (65535 - j) >> (9 - zoom);
            pyramid[{zoom, column / 256, row / 256}]
                .try_emplace(row % 256 * 256 + column % 256, layer)
                .first->second.add(code);
        }
    });
    return pyramid;
}

} // namespace scanloom::oracle

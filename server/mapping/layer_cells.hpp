#pragma once

#include "server/mapping/snapshot.hpp"

#include <array>
#include <cstddef>
#include <utility>

namespace scanloom::mapping {

/// The cells of one chunk of a layer, bottom row first.
template <class Value>
using ChunkCells = std::array<Value, std::size_t{grid::kChunkSide} * grid::kChunkSide>;

/// Returns whether any sensor has observed the cell.
[[nodiscard]] constexpr bool is_known(LogOdds cell) noexcept { return cell != kUnknownLogOdds; }
[[nodiscard]] constexpr bool is_known(HimmCount cell) noexcept { return cell != kUnseenHimm; }
[[nodiscard]] constexpr bool is_known(classify::CellClass cell) noexcept {
    return cell != classify::CellClass::kUnexplored;
}

/// Calls use(view, cells_of) and returns its result.
///
/// `view` is the ChunkView that contains the layer; cells_of(chunk) returns the layer's ChunkCells of one of its
/// chunks.
template <class Use>
decltype(auto) with_layer(const Snapshot& snapshot, Layer layer, Use&& use) {
    switch (layer) {
    case Layer::kHimm:
        return use(
            snapshot.laser, [](const LaserChunk& chunk) -> const auto& { return chunk.himm; });
    case Layer::kSonar:
        return use(
            snapshot.sonar, [](const SonarChunk& chunk) -> const auto& { return chunk.cells; });
    case Layer::kClassification:
        return use(
            snapshot.classes, [](const classify::ClassChunk& chunk) -> const auto& { return chunk.cells; });
    case Layer::kOccupancy: break;
    }
    return use(
        snapshot.laser, [](const LaserChunk& chunk) -> const auto& { return chunk.occupancy; });
}

} // namespace scanloom::mapping

#pragma once

#include "server/classify/cell_class.hpp"
#include "server/grid/bit_plane.hpp"
#include "server/mapping/himm.hpp"
#include "server/mapping/log_odds.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace scanloom::mapping {

/// 64 x 64 cells of all layers derived from laser scans.
///
/// The layers change together, so that one revision describes all of them and a cell's class always matches the
/// evidence it was derived from.
struct LaserChunk : grid::TreeItem {
    static constexpr std::size_t kCells = std::size_t{grid::kChunkSide} * grid::kChunkSide;

    std::array<LogOdds, kCells> occupancy; ///< bottom row first, as in all layers
    std::array<HimmCount, kCells> himm;
    classify::OccPlanes occ_types;

    /// Cells saturated as free: more evidence for free space does not change them, so rows with no other evidence need
    /// not be read. Checkpoints do not store these bits; a missing bit costs time but does not change results.
    grid::BitPlane settled_occupancy{};
    grid::BitPlane settled_himm{};
};

/// The verdicts of a scan for the cells of one chunk. No cell is both free and occupied.
struct ChunkVerdicts {
    grid::BitPlane free{};
    grid::BitPlane occupied{};
    std::uint64_t free_rows = 0;     ///< bit j: row j has a free cell
    std::uint64_t occupied_rows = 0; ///< bit j: row j has an occupied cell
};

} // namespace scanloom::mapping

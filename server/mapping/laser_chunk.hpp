#pragma once

#include "server/classify/cell_class.hpp"
#include "server/grid/bit_plane.hpp"
#include "server/mapping/himm.hpp"
#include "server/mapping/log_odds.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace scanloom::mapping {

/// 64 x 64 cells of all layers that lasers make. They change together, so that one revision tells what all of them
/// hold, and a class never stands beside evidence that is older or newer than what it was decided on.
struct LaserChunk : grid::TreeItem {
    static constexpr std::size_t kCells = std::size_t{grid::kChunkSide} * grid::kChunkSide;

    std::array<LogOdds, kCells> occupancy; ///< bottom row first, as everywhere
    std::array<HimmCount, kCells> himm;
    classify::OccPlanes occ_types;

    /// Cells that are as free as cells can be: more of that evidence changes nothing, and where it says no more a row
    /// need not be read. Not kept in checkpoints: a bit that is missing costs time alone.
    grid::BitPlane settled_occupancy{};
    grid::BitPlane settled_himm{};
};

/// What a scan says of the cells of one chunk. No cell is both.
struct ChunkVerdicts {
    grid::BitPlane free{};
    grid::BitPlane occupied{};
    std::uint64_t free_rows = 0;     ///< in which any cell is free, a bit a row
    std::uint64_t occupied_rows = 0; ///< likewise
};

} // namespace scanloom::mapping

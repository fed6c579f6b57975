#pragma once

#include "server/classify/hysteresis.hpp"
#include "server/mapping/himm.hpp"
#include "server/mapping/laser_chunk.hpp"
#include "server/mapping/occupancy.hpp"

/// What a scan says of a chunk, put into it: 64 cells at a time, for every instruction set that the program was built
/// for, chosen when it runs. Whole numbers throughout: all of them give the same cells.
namespace scanloom::mapping::simd {

/// Whether the verdicts would change nothing, as all they say is that settled cells are free.
[[nodiscard]] constexpr bool is_settled(const LaserChunk& chunk, const ChunkVerdicts& evidence,
                                        const ChunkVerdicts& counted) noexcept {
    std::uint64_t news = evidence.occupied_rows | counted.occupied_rows;
    for (std::size_t j = 0; j < evidence.free.size(); ++j) {
        news |= evidence.free[j] & ~chunk.settled_occupancy[j];
        news |= counted.free[j] & ~chunk.settled_himm[j];
    }
    return news == 0;
}

/// l = clamp(l + model(cell) - l0, l_min, l_max) for the cells with a verdict.
void add_evidence(LaserChunk& chunk, const ChunkVerdicts& verdicts, const OccupancyRule& rule);

/// Counts up where a hit is, down before it.
void count_hits(LaserChunk& chunk, const ChunkVerdicts& verdicts, const HimmRule& rule);

/// Brings the types of the cells in `touched` up to date; those without a value stay as they are.
void fold_types(LaserChunk& chunk, const grid::BitPlane& touched, const classify::Hysteresis<LogOdds>& by_occupancy);
void fold_types(LaserChunk& chunk, const grid::BitPlane& touched, const classify::Hysteresis<HimmCount>& by_himm);

} // namespace scanloom::mapping::simd

#pragma once

#include "core/classify/cell_class.hpp"
#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/occupancy.hpp"

/// Kernels that apply the verdicts of a scan to a chunk, 64 cells at a time. They are compiled for several instruction
/// sets; the one to use is selected at run time. The arithmetic uses integers only, so that all instruction sets give
/// the same cells.
namespace scanloom::mapping::simd {

/// Returns whether the verdicts change nothing, because they only report free space in cells that are already saturated
/// as free.
/// @param chunk     the cells before the scan
/// @param evidence  verdicts for the occupancy layer
/// @param counted   verdicts for the HIMM layer
[[nodiscard]] constexpr bool is_saturated(const LaserChunk& chunk, const ChunkVerdicts& evidence,
                                          const ChunkVerdicts& counted) noexcept {
    std::uint64_t news = evidence.occupied_rows | counted.occupied_rows;
    for (std::size_t j = 0; j < evidence.free.size(); ++j) {
        news |= evidence.free[j] & ~chunk.saturated_occupancy[j];
        news |= counted.free[j] & ~chunk.saturated_himm[j];
    }
    return news == 0;
}

/// Adds the evidence of a scan to the occupancy layer: l = clamp(l + model(cell) - l0, l_min, l_max) for each cell with
/// a verdict.
/// @param chunk     changed
/// @param verdicts  of one scan for this chunk
/// @param rule      evidence, prior and clamp
/// Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.1.
void add_evidence(LaserChunk& chunk, const ChunkVerdicts& verdicts, const OccupancyRule& rule);

/// Updates the HIMM layer: increments the counters of occupied cells and decrements those of free cells.
/// @param chunk     changed
/// @param verdicts  of one scan for this chunk
/// @param rule      increment and decrement
/// Source: Borenstein, Koren, Histogramic In-Motion Mapping (1991), section III.
void count_hits(LaserChunk& chunk, const ChunkVerdicts& verdicts, const HimmRule& rule);

/// Updates the types of the cells in `touched` from their log-odds. Cells without a value keep their type.
/// @param chunk         changed
/// @param touched       the cells that a scan changed
/// @param by_occupancy  limits, in log-odds
void update_types(LaserChunk& chunk, const grid::BitPlane& touched, const classify::Hysteresis<LogOdds>& by_occupancy);
/// Updates the types of the cells in `touched` from their HIMM counters. Cells without a value keep their type.
/// @param chunk    changed
/// @param touched  the cells that a scan changed
/// @param by_himm  limits, 0..15
void update_types(LaserChunk& chunk, const grid::BitPlane& touched, const classify::Hysteresis<HimmCount>& by_himm);

} // namespace scanloom::mapping::simd

#pragma once

#include "core/classify/cell_class.hpp"
#include "core/grid/chunk.hpp"
#include "core/mapping/map_config.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace scanloom::mapping {

/// Natural log-odds l = ln(p / (1 - p)) in steps of 1/2048.
///
/// Integers keep a map bit-for-bit equal however its scans were grouped, replayed or resumed. The range is +-15.99 (p
/// up to 1 - 1e-7).
using LogOdds = std::int16_t;

inline constexpr double kLogOddsScale = 2048.0; ///< steps of LogOdds in one unit of log-odds

/// Marks a cell that no scan has reached. Arithmetic never produces this value.
inline constexpr LogOdds kUnknownLogOdds = std::numeric_limits<LogOdds>::min();

/// Returns ln(p / (1 - p)); 0 < p < 1 for a finite result.
/// @param probability  of occupation, 0..1
[[nodiscard]] inline double log_odds_of(double probability) noexcept {
    return std::log(probability / (1.0 - probability));
}

/// Converts log-odds to fixed point, rounding to the nearest step.
/// @param log_odds  natural log-odds
/// Precondition: |log_odds| < 15.99.
[[nodiscard]] inline LogOdds to_fixed(double log_odds) noexcept {
    return static_cast<LogOdds>(std::lround(log_odds * kLogOddsScale));
}

/// Returns the probability p = 1 / (1 + exp(-l)).
/// @param fixed  value of a known cell
/// Precondition: the value is not kUnknownLogOdds.
[[nodiscard]] inline double probability_of(LogOdds fixed) noexcept {
    return 1.0 / (1.0 + std::exp(-static_cast<double>(fixed) / kLogOddsScale));
}

/// Certainty that a cell is occupied, 0..15.
using HimmCount = std::uint8_t;

inline constexpr HimmCount kHimmMax = 15;     ///< a cell that is certainly occupied
inline constexpr HimmCount kUnseenHimm = 255; ///< no scan has reached the cell; differs from a counter of 0

/// The rule of histogramic in-motion mapping (HIMM): a hit increments the counter of its cell, and the cells before the
/// hit are decremented. Counters stay within 0..15; those of unseen cells start at 0.
/// Source: Borenstein, Koren, Histogramic In-Motion Mapping for Mobile Robot Obstacle Avoidance (1991), section III.
struct HimmRule {
    /// Takes the increment and the decrement from a session's settings.
    explicit HimmRule(const MapConfig& config) noexcept : up(config.himm_increment), down(config.himm_decrement) {}

    int up;   ///< 1..15
    int down; ///< 1..15
};

/// 64 x 64 cells of all layers derived from laser scans.
///
/// The layers change together, so that one revision describes all of them and a cell's class always matches the
/// evidence it was derived from.
struct LaserChunk : grid::TreeItem {
    static constexpr std::size_t kCells = std::size_t{grid::kChunkSide} * grid::kChunkSide; ///< cells of a chunk

    std::array<LogOdds, kCells> occupancy; ///< bottom row first, as in all layers
    std::array<HimmCount, kCells> himm;    ///< counters, or kUnseenHimm
    classify::OccPlanes occ_types;         ///< with hysteresis, from the layer that MapConfig::class_source names

    /// Cells saturated as free: more evidence for free space does not change them, so rows with no other evidence need
    /// not be read. Checkpoints do not store these bits; a missing bit costs time but does not change results.
    grid::BitPlane saturated_occupancy{};
    grid::BitPlane saturated_himm{}; ///< likewise: counters of 0
};

/// The verdicts of a scan for the cells of one chunk. No cell is both free and occupied.
struct ChunkVerdicts {
    grid::BitPlane free{};           ///< set: the scan shows that the cell is free
    grid::BitPlane occupied{};       ///< set: the scan shows that the cell is occupied
    std::uint64_t free_rows = 0;     ///< bit j: row j has a free cell
    std::uint64_t occupied_rows = 0; ///< bit j: row j has an occupied cell
};

} // namespace scanloom::mapping

#pragma once

#include "server/mapping/map_config.hpp"

#include <cstdint>

namespace scanloom::mapping {

/// Certainty that a cell is occupied, 0..15.
using HimmCount = std::uint8_t;

inline constexpr HimmCount kHimmMax = 15;
inline constexpr HimmCount kUnseenHimm = 255; ///< no scan has reached the cell; differs from a counter of 0

/// The rule of histogramic in-motion mapping (HIMM): a hit increments the counter of its cell, and the cells before the
/// hit are decremented. Counters stay within 0..15; those of unseen cells start at 0.
/// Source: Borenstein, Koren, Histogramic In-Motion Mapping for Mobile Robot Obstacle Avoidance (1991), section III.
struct HimmRule {
    explicit HimmRule(const MapConfig& config) noexcept : up(config.himm_increment), down(config.himm_decrement) {}

    int up;   ///< 1..15
    int down; ///< 1..15
};

} // namespace scanloom::mapping

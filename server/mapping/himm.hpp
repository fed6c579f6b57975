#pragma once

#include "server/mapping/map_config.hpp"

#include <cstdint>

namespace scanloom::mapping {

/// A cell's certainty that it is occupied, 0..15.
using HimmCount = std::uint8_t;

inline constexpr HimmCount kHimmMax = 15;
inline constexpr HimmCount kUnseenHimm = 255; ///< a cell that no scan has reached; not one counted down to 0

/// Histogramic in-motion mapping: counts up where a hit is, down before it, within 0..15, unseen cells starting from 0.
/// Source  Borenstein, Koren, Histogramic In-Motion Mapping for Mobile Robot Obstacle Avoidance (1991), section III.
struct HimmRule {
    explicit HimmRule(const MapConfig& config) noexcept : up(config.himm_increment), down(config.himm_decrement) {}

    int up;   ///< 1..15
    int down; ///< 1..15
};

} // namespace scanloom::mapping

#pragma once

#include "server/mapping/inverse_sensor_model.hpp"
#include "server/mapping/map_config.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

namespace scanloom::mapping {

/// A cell's certainty that it is occupied, 0..15.
using HimmCount = std::uint8_t;

inline constexpr HimmCount kHimmMax = 15;
inline constexpr HimmCount kUnseenHimm = 255; ///< a cell that no scan has reached; not one counted down to 0

/// Histogramic in-motion mapping: counts up where a hit is, down before it.
/// Source  Borenstein, Koren, Histogramic In-Motion Mapping for Mobile Robot Obstacle Avoidance (1991), section III.
struct HimmRule {
    explicit HimmRule(const MapConfig& config) noexcept : up(config.himm_increment), down(config.himm_decrement) {}

    void apply(std::span<HimmCount> cells, Verdict verdict) const noexcept {
        const int step = verdict == Verdict::kOccupied ? up : -down;
        for (HimmCount& cell : cells) {
            const int before = cell == kUnseenHimm ? 0 : cell;
            cell = static_cast<HimmCount>(std::clamp<int>(before + step, 0, kHimmMax));
        }
    }

    int up;
    int down;
};

} // namespace scanloom::mapping

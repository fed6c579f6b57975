#pragma once

#include "common/scan/scan.hpp"

#include <algorithm>
#include <optional>

namespace scanloom {

/// How the readings of a sensor are interpreted.
struct ReadingRules {
    double range_min = 0.0;      ///< metres
    double range_max = 0.0;      ///< metres
    bool drop_no_return = false; ///< whether beams without a return are ignored
};

/// What one beam shows: free space up to `metres`, and an obstacle there if `is_hit`.
struct Reading {
    double metres = 0.0; ///< length of the free part of the beam
    bool is_hit = false; ///< whether an obstacle ends it
};

/// Interprets the reading of one beam.
/// @param range  millimetres, or kInvalidRange or kNoReturn
/// @param rules  of the sensor that took it
/// @return nullopt if the beam shows nothing: the reading is invalid, below range_min, or a no-return that is dropped
[[nodiscard]] inline std::optional<Reading> reading_of(RangeMm range, const ReadingRules& rules) noexcept {
    if (range == kInvalidRange) return std::nullopt;
    const double metres = range == kNoReturn ? rules.range_max : range * 0.001;
    if (metres < rules.range_min) return std::nullopt;
    if (metres < rules.range_max) return Reading{metres, true};
    if (rules.drop_no_return) return std::nullopt;
    return Reading{rules.range_max, false};
}

} // namespace scanloom

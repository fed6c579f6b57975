#pragma once

#include "common/scan/scan.hpp"

#include <algorithm>
#include <optional>

namespace scanloom {

/// Which readings of a sensor mean what.
struct ReadingRules {
    double range_min = 0.0;      ///< metres
    double range_max = 0.0;      ///< metres
    bool drop_no_return = false; ///< beams without a return show nothing
};

/// What one beam shows: everything up to `metres` is free, and where it is a hit, there is something.
struct Reading {
    double metres = 0.0;
    bool is_hit = false;
};

/// Nothing for a beam that shows nothing: an invalid reading, or one below range_min.
[[nodiscard]] inline std::optional<Reading> reading_of(RangeMm range, const ReadingRules& rules) noexcept {
    if (range == kInvalidRange) return std::nullopt;
    const double metres = range == kNoReturn ? rules.range_max : range * 0.001;
    if (metres < rules.range_min) return std::nullopt;
    if (metres < rules.range_max) return Reading{metres, true};
    if (rules.drop_no_return) return std::nullopt;
    return Reading{rules.range_max, false};
}

} // namespace scanloom

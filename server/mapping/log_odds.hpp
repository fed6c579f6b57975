#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace scanloom::mapping {

/// Natural log-odds l = ln(p / (1 - p)) in steps of 1/2048.
///
/// Integers keep a map bit-for-bit equal however its scans were grouped, replayed or resumed. The range is +-15.99 (p
/// up to 1 - 1e-7).
using LogOdds = std::int16_t;

inline constexpr double kLogOddsScale = 2048.0;

/// Marks a cell that no scan has reached. Arithmetic never produces this value.
inline constexpr LogOdds kUnknownLogOdds = std::numeric_limits<LogOdds>::min();

/// Returns ln(p / (1 - p)); 0 < p < 1 for a finite result.
[[nodiscard]] inline double log_odds_of(double probability) noexcept {
    return std::log(probability / (1.0 - probability));
}

/// Converts log-odds to fixed point, rounding to the nearest step.
/// Precondition: |log_odds| < 15.99.
[[nodiscard]] inline LogOdds to_fixed(double log_odds) noexcept {
    return static_cast<LogOdds>(std::lround(log_odds * kLogOddsScale));
}

/// Returns the probability p = 1 / (1 + exp(-l)).
/// Precondition: the value is not kUnknownLogOdds.
[[nodiscard]] inline double probability_of(LogOdds fixed) noexcept {
    return 1.0 / (1.0 + std::exp(-static_cast<double>(fixed) / kLogOddsScale));
}

} // namespace scanloom::mapping

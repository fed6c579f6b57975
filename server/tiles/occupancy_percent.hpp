#pragma once

#include "server/mapping/log_odds.hpp"

#include <array>
#include <cstdint>

namespace scanloom::tiles {

/// How tiles and map images show a cell: the probability of occupation in whole percent, 0..100.
using Percent = std::uint8_t;

inline constexpr Percent kUnknownPercent = 255;
inline constexpr std::uint8_t kUnknownGrey = 128;

/// How much a percentage counts among others that share a pixel: the furthest above 50 counts most, then the
/// lowest known one, unknown least. A coarse pixel is the greatest salience below it, so that walls survive
/// every zoom, and tiles made from finer tiles or from the cells are the same bytes.
using Salience = std::uint8_t;

inline constexpr Salience kUnknownSalience = 0;

[[nodiscard]] constexpr Salience salience_of(Percent percent) noexcept {
    if (percent > 100) return kUnknownSalience;
    return static_cast<Salience>(percent > 50 ? percent + 1 : 51 - percent);
}

[[nodiscard]] constexpr Percent percent_of_salience(Salience salience) noexcept {
    if (salience == kUnknownSalience) return kUnknownPercent;
    return static_cast<Percent>(salience > 51 ? salience - 1 : 51 - salience);
}

/// White is free, black occupied: 255 (1 - p), rounded; a half rounds down, which keeps a known cell at
/// even odds (127) apart from an unknown one (128).
[[nodiscard]] constexpr std::uint8_t grey_of(Percent percent) noexcept {
    return percent > 100 ? kUnknownGrey : static_cast<std::uint8_t>((255 * (100 - percent) + 49) / 100);
}

/// Percent of every fixed-point log-odds, indexed by its bits as uint16.
using PercentTable = std::array<Percent, 65536>;
[[nodiscard]] const PercentTable& percent_table();

/// Salience of every fixed-point log-odds, likewise.
using SalienceTable = std::array<Salience, 65536>;
[[nodiscard]] const SalienceTable& salience_table();

} // namespace scanloom::tiles

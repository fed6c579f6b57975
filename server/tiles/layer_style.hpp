#pragma once

#include "core/mapping/laser_chunk.hpp"
#include "core/mapping/layer.hpp"

#include <array>
#include <cstdint>

namespace scanloom::tiles {

/// The value of a cell in tiles and map images: the probability of occupation in whole percent, 0..100.
using Percent = std::uint8_t;

inline constexpr Percent kUnknownPercent = 255;
inline constexpr std::uint8_t kUnknownGrey = 128;

/// The weight of a percentage among the cells that share a pixel: the furthest above 50 has the greatest salience, then
/// the lowest known one; unknown has the least.
///
/// A coarse pixel shows the greatest salience of its cells, so that walls remain visible at every zoom, and tiles made
/// from finer tiles or from the cells have the same bytes.
using Salience = std::uint8_t;

inline constexpr Salience kUnknownSalience = 0;

/// Returns the salience of a percentage.
[[nodiscard]] constexpr Salience salience_of(Percent percent) noexcept {
    if (percent > 100) return kUnknownSalience;
    return static_cast<Salience>(percent > 50 ? percent + 1 : 51 - percent);
}

/// Returns the grey of a percentage: 255 (1 - p), rounded. White is free, black is occupied. A half rounds down, which
/// keeps a known cell at even odds (127) distinct from an unknown one (128).
[[nodiscard]] constexpr std::uint8_t grey_of(Percent percent) noexcept {
    return percent > 100 ? kUnknownGrey : static_cast<std::uint8_t>((255 * (100 - percent) + 49) / 100);
}

/// The percentage of every fixed-point log-odds, indexed by its bits as uint16.
using PercentTable = std::array<Percent, 65536>;
[[nodiscard]] const PercentTable& percent_table();

/// The salience of every fixed-point log-odds, indexed by its bits as uint16.
using SalienceTable = std::array<Salience, 65536>;
[[nodiscard]] const SalienceTable& salience_table();

/// The value of a cell in a tile or a map image, one byte:
///   occupancy, sonar  the probability of occupation in percent, 0..100; 255 unknown
///   himm              the counter, 0..15; 255 unseen
///   classification    classify::CellClass: 0 unexplored, 1 free, 2 occupied, 3 frontier, 4 danger
using Code = std::uint8_t;

struct Colour {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;

    friend bool operator==(const Colour&, const Colour&) = default;
};

/// The display of a layer.
struct LayerStyle {
    Code unknown;                       ///< of a cell that no sensor has observed
    std::array<Salience, 256> salience; ///< by code; a pixel shows the most salient of its cells
    std::array<Code, 256> code;         ///< by salience
    std::array<Colour, 256> palette;    ///< by code
    bool is_grey;                       ///< whether all colours of the palette are grey
};

/// Returns the style of a layer.
///
/// Saliences, greatest first:
///   occupancy, sonar  the furthest above 50 %, then the lowest known one, then unknown
///   himm              the highest counter, then unseen
///   classification    occupied, danger, frontier, free, unexplored
/// Colours: white is free, black is occupied, mid-grey is unknown. For classes: unexplored is grey, free is pale
/// yellow, occupied is dark brown, frontier is green, danger is red.
[[nodiscard]] const LayerStyle& style_of(mapping::Layer layer);

} // namespace scanloom::tiles

#pragma once

#include "server/mapping/layer.hpp"
#include "server/tiles/occupancy_percent.hpp"

#include <array>
#include <cstdint>

namespace scanloom::tiles {

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

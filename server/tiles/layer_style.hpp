#pragma once

#include "server/mapping/layer.hpp"
#include "server/tiles/occupancy_percent.hpp"

#include <array>
#include <cstdint>

namespace scanloom::tiles {

/// What a tile or a map image holds for a cell, one byte:
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

/// How a layer is shown.
struct LayerStyle {
    Code unknown;                       ///< of a cell that nobody saw
    std::array<Salience, 256> salience; ///< of each code: which of the cells that share a pixel it shows
    std::array<Code, 256> code;         ///< of each salience
    std::array<Colour, 256> palette;    ///< of each code
    bool is_grey;                       ///< all colours of the palette are
};

/// Saliences, greatest first:
///   occupancy, sonar  the furthest above 50 %, then the lowest known one, then unknown
///   himm              the highest counter, then unseen
///   classification    occupied, danger, frontier, free, unexplored
/// Colours: white is free and black occupied, mid-grey unknown; of classes, unexplored grey, free pale yellow, occupied
/// dark brown, frontier green, danger red.
[[nodiscard]] const LayerStyle& style_of(mapping::Layer layer);

} // namespace scanloom::tiles

#pragma once

#include "server/mapping/sweep/contours.hpp"

#include <array>
#include <cstdint>

namespace scanloom::mapping::simd {

/// Some rows of cells, a bit a cell, as words of 64: first all rows of the 64 columns on the left, and so on.
struct Strip {
    double sensor_x = 0.0;    ///< within its cell, 0 .. 1
    double sensor_y = 0.0;    ///< likewise
    std::int32_t column = 0;  ///< of the first bit, counted from the sensor's cell
    std::int32_t row = 0;     ///< of the first row, likewise
    std::int32_t columns = 0; ///< a multiple of 64
    std::int32_t rows = 0;    ///< a multiple of 64
};

/// A plane of a strip's bits for each contour: the first for what is within the innermost one, each other for what lies
/// between two.
using Planes = std::array<std::uint64_t*, kContoursMax>;

/// Flips the first bit at or behind each crossing of a plane's borders with the line through the centres of a row's
/// cells: the cells inside are then those with an odd number of flipped bits up to them. Each row is crossed an even
/// number of times, exactly, as pieces that meet do so in the very same number.
///
/// Contours mostly run side by side: along an edge between sectors only the parts in which two of them differ cross a
/// plane between them, so that a step from a near beam to a far one is followed once, in the first plane.
/// Pre  strip.columns hold the contours. Cost  sectors, and crossings.
/// Source  the parity rule of scan conversion: Foley, van Dam et al., Computer Graphics (1990), section 3.6.
void flip_crossings(const Contours& contours, const Strip& strip, const Planes& planes);

} // namespace scanloom::mapping::simd

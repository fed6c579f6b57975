#pragma once

#include "core/mapping/sweep/contours.hpp"

#include <array>
#include <cstdint>

namespace scanloom::mapping::simd {

/// A strip of rows of cells with one bit per cell, stored as words of 64 columns: first all rows of the leftmost 64
/// columns, then all rows of the next, and so on.
struct Strip {
    double sensor_x = 0.0;    ///< position within the sensor's cell, 0 .. 1
    double sensor_y = 0.0;    ///< likewise
    std::int32_t column = 0;  ///< first column, relative to the sensor's cell
    std::int32_t row = 0;     ///< first row, relative to the sensor's cell
    std::int32_t columns = 0; ///< a multiple of 64
    std::int32_t rows = 0;    ///< a multiple of 64
};

/// One plane of a strip's bits for each contour: the first for the area within the innermost contour, each other for
/// the area between two contours.
using Planes = std::array<std::uint64_t*, kContoursMax>;

/// Flips the first bit at or after each crossing of a plane's borders with the line through the centres of a row of
/// cells.
///
/// A cell is inside if the number of flipped bits up to and including its own is odd. Each row is crossed an even
/// number of times, exactly, because pieces that meet do so at the same floating-point number.
///
/// Contours mostly run side by side. Along an edge between sectors, only the parts in which two contours differ cross
/// the plane between them. A step from a near beam to a far one is therefore traced once, in the first plane.
/// @param contours  of the scan
/// @param strip     which rows and columns the planes hold
/// @param planes    changed; one for each contour
/// Precondition: the strip's columns contain the contours.
/// Cost: sectors and crossings.
/// Source: the parity rule of scan conversion: Foley, van Dam et al., Computer Graphics (1990), section 3.6.
void flip_crossings(const Contours& contours, const Strip& strip, const Planes& planes);

} // namespace scanloom::mapping::simd

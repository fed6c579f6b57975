#pragma once

#include "server/mapping/laser_chunk.hpp"
#include "server/mapping/sweep/fan_ring.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

/// The arithmetic of a sweep, eight or four or two sectors at a time: each function for every instruction set that the
/// program was built for, chosen when it runs. All of them give the same bits: nothing but +, -, *, /, square roots
/// and rounding up is used, none of it fused, and each sector's operations are those of every other.
namespace scanloom::mapping::simd {

/// The edges of a ring, turned into the map frame. Room for sectors + 1 + kRingPadding values each.
struct Edges {
    double* x;
    double* y;
};

/// Turns the ring's edges by an angle's cosine and sine.
void turn_edges(const FanRing& ring, double cosine, double sine, const Edges& turned);

/// How long what a reading shows is, in cells.
struct RadiusRule {
    double range_min = 0.0; ///< metres, and the same below
    double range_max = 0.0;
    double half_band = 0.0; ///< alpha / 2
    double cells_per_metre = 0.0;
    bool drop_no_return = false;
};

/// Of each sector, up to where it is free, and up to where it is free or occupied; 0 where it shows nothing.
/// @param millimetres  one a sector, and kRingPadding more; 0: invalid; what exceeds range_max: no return.
/// Source  section 3 of the design models, model 1.
void radii_of(const std::int32_t* millimetres, std::size_t sectors, const RadiusRule& rule, double* inner,
              double* outer);

inline constexpr std::size_t kContoursMax = 4;

/// Areas that a scan sees, each within the next: of each sector of a ring, all that is nearer than a radius.
///
/// The border of each is one closed line of arcs and of straight pieces along the edges between sectors.
/// Units   cells
/// Frames  x and y along the map's axes; the sensor at the origin.
/// Shapes  sectors + 1 edges, then kRingPadding that do not count; radii likewise, sectors of them, where
///         radius[k][-1] is the last one, and no radius[k] is more than that of k + 1.
struct Contours {
    Edges edges;
    std::size_t sectors = 0;
    std::size_t count = 0; ///< 2 or 4
    std::array<const double*, kContoursMax> radius{};
};

struct Box {
    double x_min = 0.0;
    double y_min = 0.0;
    double x_max = 0.0;
    double y_max = 0.0;
};

/// What holds the outermost contour and the sensor.
[[nodiscard]] Box box_of(const Contours& contours);

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

/// One chunk's bits in each plane, and what they inherit.
struct ChunkWords {
    Planes flipped; ///< 64 words
    Planes carry;   ///< a word a row, all ones where the chunk to the left ended inside; 0 before the first
};

/// Turns flipped bits into cells. Clears them, and carries on.
/// Of 2 contours: the cells within both are free, those between them occupied. Of 4 so those of the inner two, and in
/// `wide` those of the outermost and the innermost.
void fill_bands(const ChunkWords& words, std::size_t contours, ChunkVerdicts& narrow, ChunkVerdicts* wide);

} // namespace scanloom::mapping::simd

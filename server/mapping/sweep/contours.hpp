#pragma once

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

} // namespace scanloom::mapping::simd

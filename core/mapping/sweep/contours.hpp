#pragma once

#include "core/mapping/sweep/sweep.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

/// Vectorised arithmetic of a sweep, for two, four or eight sectors at a time. Each function is compiled for several
/// instruction sets; the one to use is selected at run time. All of them give the same bits: they use only +, -, *, /,
/// square roots and rounding up, without fused operations, and process all sectors with the same operations.
namespace scanloom::mapping::simd {

/// The edges of a ring in map directions. Each array has room for sectors + 1 + kRingPadding values.
struct Edges {
    double* x; ///< components along x
    double* y; ///< components along y
};

/// Rotates the ring's edges by an angle.
/// @param ring    edges in the sensor frame
/// @param cosine  of the angle
/// @param sine    of the angle
/// @param turned  receives the edges in map directions
void turn_edges(const FanRing& ring, double cosine, double sine, const Edges& turned);

/// The rule that converts a reading to radii in cells.
struct RadiusRule {
    double range_min = 0.0;       ///< metres, and the same below
    double range_max = 0.0;       ///< metres; readings from here on are no returns
    double half_band = 0.0;       ///< alpha / 2
    double cells_per_metre = 0.0; ///< 1 / cell_size
    bool drop_no_return = false;  ///< whether readings without a return show nothing
};

/// Computes for each sector the radius of the free area and the radius of the free and occupied area; both are 0 if the
/// reading shows nothing.
/// @param millimetres  one reading per sector, followed by kRingPadding values; 0: invalid; greater than range_max: no
///                     return
/// @param sectors  number of sectors
/// @param rule  sensor limits and cell size
/// @param inner  receives the radius of the free area, in cells
/// @param outer  receives the radius of the free and occupied area, in cells
/// Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), section 9.2.
void radii_of(const std::int32_t* millimetres, std::size_t sectors, const RadiusRule& rule, double* inner,
              double* outer);

inline constexpr std::size_t kContoursMax = 4; ///< two for each band of a sweep

/// Nested areas that a scan sees: for each sector of a ring, everything nearer than a radius.
///
/// The border of each area is one closed line of arcs and of straight pieces along the edges between sectors. Lengths
/// are in cells; x and y are parallel to the map's axes, with the sensor at the origin.
///
/// The edges are sectors + 1 values followed by kRingPadding unused values. The radii are `sectors` values with the
/// same padding; radius[k][-1] equals the last one, and no value of radius[k] is greater than that of radius[k + 1].
struct Contours {
    Edges edges;                                      ///< unit vectors in map directions
    std::size_t sectors = 0;                          ///< of the ring
    std::size_t count = 0;                            ///< 2 or 4
    std::array<const double*, kContoursMax> radius{}; ///< cells, from the innermost contour to the outermost
};

/// A rectangle in cells, relative to the sensor.
struct Box {
    double x_min = 0.0; ///< cells
    double y_min = 0.0; ///< cells
    double x_max = 0.0; ///< cells
    double y_max = 0.0; ///< cells
};

/// Returns the bounding box of the outermost contour and the sensor.
/// @param contours  at least one
[[nodiscard]] Box box_of(const Contours& contours);

} // namespace scanloom::mapping::simd

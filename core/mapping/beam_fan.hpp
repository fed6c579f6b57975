#pragma once

#include "common/scan/beam_angles.hpp"

#include <cstdint>
#include <numbers>
#include <vector>

namespace scanloom::mapping {

/// A direction in the sensor frame as a unit vector.
struct Direction {
    double x = 1.0; ///< cosine of the angle
    double y = 0.0; ///< sine of the angle
};

/// The largest angular width of a Sector, in radians. A wider beam has several sectors.
inline constexpr double kSectorWidthMax = std::numbers::pi / 24.0;

/// The directions from `low` counter-clockwise up to, but not including, `high`, for which one beam is the nearest and
/// near enough. At most kSectorWidthMax wide.
struct Sector {
    std::uint32_t beam = 0; ///< index of the beam
    Direction low;          ///< in the sensor frame; included
    Direction high;         ///< in the sensor frame; excluded
};

/// Non-overlapping sectors that assign the directions around a sensor to the beams of a scan: the nearest-beam rule of
/// the inverse sensor model.
/// Source: Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.2, lines 3 and 4.
using BeamFan = std::vector<Sector>;

/// Divides the directions around a sensor among its beams.
///
/// The aperture is replaced by the beam spacing where the spacing is larger, so that no gap opens between neighbours.
/// For uniform angles, the spacing is the increment. For explicit angles, which may be uneven, it is the gap itself, up
/// to four times the median gap. A wider gap is a blind part of the circle: it stays unseen except for half an
/// aperture, or half a median gap, at each end. The widest gap is excluded from the median because it is usually the
/// part behind the sensor.
///
/// A direction exactly half-way between two beams belongs to the counter-clockwise one. Rounding may move this border,
/// but each direction belongs to exactly one of the two beams.
/// @param angles  1..4096 finite angles in radians, modulo a full turn, in any order; of beams with the same direction,
///                the one with the lowest index counts
/// @param aperture  full width beta of a beam in radians; 0 < aperture <= pi
[[nodiscard]] BeamFan make_beam_fan(const BeamAngles& angles, double aperture);

} // namespace scanloom::mapping

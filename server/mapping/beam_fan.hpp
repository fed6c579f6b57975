#pragma once

#include "common/scan/beam_angles.hpp"

#include <cstdint>
#include <numbers>
#include <vector>

namespace scanloom::mapping {

/// A direction in the sensor frame as a unit vector.
struct Direction {
    double x = 1.0;
    double y = 0.0;
};

/// Directions for which one beam is the nearest and near enough: from `low` counter-clockwise up to, but
/// not including, `high`; at most kSectorWidthMax. A wider beam has several sectors.
inline constexpr double kSectorWidthMax = std::numbers::pi / 24.0; ///< radians

struct Sector {
    std::uint32_t beam = 0;
    Direction low;
    Direction high;
};

/// How the beams of a scan divide the directions around a sensor: the nearest-beam rule of the
/// inverse sensor model as sectors that overlap nowhere.
/// Source  Thrun, Burgard, Fox, Probabilistic Robotics (2005), Table 9.2, lines 3 and 4.
using BeamFan = std::vector<Sector>;

/// Angles modulo a full turn in any order; of beams with the same direction the lowest index counts.
/// A direction exactly half-way between two beams belongs to the counter-clockwise one: which of the
/// two is below what rounding can tell, but never both and never neither.
///
/// Units   radians; `aperture` is the full width beta of a beam. The beam spacing is used where it is
///         larger, so that no gap opens between neighbours: the increment of uniform angles; for explicit
///         ones, which need not be even, the gap itself up to four times the median gap. What is wider
///         is a blind part of the circle and stays unseen but for half an aperture, or median gap, at its ends.
///         (The widest gap does not count for the median: mostly it is the part behind the sensor.)
/// Pre     1..4096 finite angles; 0 < aperture <= pi.
[[nodiscard]] BeamFan make_beam_fan(const BeamAngles& angles, double aperture);

} // namespace scanloom::mapping

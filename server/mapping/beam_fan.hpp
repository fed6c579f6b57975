#pragma once

#include "common/scan/beam_angles.hpp"

#include <cstdint>
#include <vector>

namespace scanloom::mapping {

/// A direction in the sensor frame as a unit vector.
struct Direction {
    double x = 1.0;
    double y = 0.0;
};

/// The directions for which one beam is the nearest and within half the aperture: from `low`
/// counter-clockwise up to, but not including, `high`; at most a quarter turn.
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
///         larger, so that no gap opens between neighbours: the increment of uniform angles, the
///         median gap of explicit ones (so that a blind part of the circle stays unseen).
/// Pre     1..4096 finite angles; 0 < aperture <= pi.
[[nodiscard]] BeamFan make_beam_fan(const BeamAngles& angles, double aperture);

/// The beam spacing as above; 0 for a single beam.
[[nodiscard]] double beam_spacing(const BeamAngles& angles);

} // namespace scanloom::mapping

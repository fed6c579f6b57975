#pragma once

#include "common/scan/scan.hpp"

#include <optional>
#include <span>

namespace scanloom::landmarks {

/// What a filter did to a scan.
struct FilterFigures {
    /// Metres: the root of the mean of the squared distances from each point to the unfiltered one of its beam. 0
    /// where there are none.
    double rmse = 0.0;
    /// How much less rough the scan is along each axis of the sensor: 1 - after / before. 1: all noise is gone; below
    /// 0: there is more. Nothing where there was no roughness. Roughness is the median of |a - 2 b + c| of the points
    /// a, b, c of each three neighbouring beams that are all returns: 0 on a straight wall of evenly spaced points,
    /// and being a median, not disturbed by corners and jumps.
    std::optional<double> noise_reduction_x;
    std::optional<double> noise_reduction_y;

    friend bool operator==(const FilterFigures&, const FilterFigures&) = default;
};

/// Shapes  before, after: the ranges of one scan, the same beams returns in both; angles: their directions.
/// Pre     one range a beam.
[[nodiscard]] FilterFigures filter_figures(std::span<const RangeMm> before, std::span<const RangeMm> after,
                                           const BeamAngles& angles);

/// Whether the last beam's neighbour is the first: what lies between their directions is no wider than two and a half
/// of the mean steps from beam to beam, so that one beam may be missing there. A scan that repeats its first direction
/// at its end is a full circle; fewer than three beams are none.
[[nodiscard]] bool is_full_circle(const BeamAngles& angles);

} // namespace scanloom::landmarks

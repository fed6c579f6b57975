#pragma once

#include "common/scan/scan.hpp"

#include <optional>
#include <span>

namespace scanloom::landmarks {

/// How a filter changed a scan.
struct FilterFigures {
    /// Metres: the root mean square distance of each point to the unfiltered point of its beam. 0 if there are no
    ///     points.
    double rmse = 0.0;
    /// How much smoother the scan became along each axis of the sensor: 1 - after / before. 1: all noise is gone; below
    /// 0: there is more noise; nullopt: there was no roughness.
    ///
    /// Roughness is the median of |a - 2 b + c| over the points a, b, c of each three neighbouring beams that are all
    /// returns. It is 0 on a straight wall of evenly spaced points and, as a median, not affected by corners and jumps.
    std::optional<double> noise_reduction_x;
    std::optional<double> noise_reduction_y; ///< likewise, along y

    friend bool operator==(const FilterFigures&, const FilterFigures&) = default;
};

/// Computes how a filter changed a scan.
/// @param before  ranges of the scan, one for each beam
/// @param after   filtered ranges; the same beams are returns as in `before`
/// @param angles  directions of the beams
[[nodiscard]] FilterFigures filter_figures(std::span<const RangeMm> before, std::span<const RangeMm> after,
                                           const BeamAngles& angles);

/// Returns whether the last beam is next to the first one.
///
/// It is if the angle between them is at most two and a half times the mean step from beam to beam, so that one beam
/// may be missing there. A scan that repeats its first direction at its end is a full circle. Fewer than three beams
/// are not.
/// @param angles  radians, in the order of the beams
[[nodiscard]] bool is_full_circle(const BeamAngles& angles);

} // namespace scanloom::landmarks

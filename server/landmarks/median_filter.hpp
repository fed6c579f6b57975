#pragma once

#include "common/error/error.hpp"
#include "common/scan/scan.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace scanloom::landmarks {

inline constexpr std::size_t kMedianWindowMax = 101; ///< beams; from about 15 on corners go round, from 51 they go

/// Each return becomes the median of the returns among the `window` beams around it, itself in the middle. So nothing
/// becomes a return that was none, and no return is lost. Of an even count it is the mean of the middle two, half
/// millimetres down. Windows end with the scan, unless it is a full circle: then its last beam stands beside its first.
/// A window holds no beam twice, however small the circle.
///
/// Shapes  ranges: one a beam, in the order of their directions.
/// Errors  kInvalidField: window is even or not in 1 .. kMedianWindowMax.
/// Cost    n * window.
[[nodiscard]] Result<std::vector<RangeMm>> median_filtered(std::span<const RangeMm> ranges, std::size_t window,
                                                           bool full_circle);

/// Whether the last beam's neighbour is the first: what lies between their directions is no wider than two and a half
/// of the mean steps from beam to beam, so that one beam may be missing there. A scan that repeats its first direction
/// at its end is a full circle; fewer than three beams are none.
[[nodiscard]] bool is_full_circle(const BeamAngles& angles);

} // namespace scanloom::landmarks

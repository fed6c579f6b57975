#pragma once

#include "common/scan/scan.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::robot {

inline constexpr int kMedianWindowMin = 3;
inline constexpr int kMedianWindowMax = 101; ///< beams; from about 15 on corners go round, from 51 on they go

/// Each return becomes the median of itself and its neighbours, as many on either side: half of `window`, or fewer
/// where the neighbours end: at a beam that is no return, and at a gap of more than four times the median gap. So
/// nothing becomes a return that was none, no return is lost, and nothing is mixed across what was not seen.
///
/// Shapes  `steps`: the direction of each beam, rising, all within one turn of `steps_per_turn`; beams are neighbours
///         across its begin, too.
/// Pre     window odd, 1 (nothing changes) to kMedianWindowMax; ranges.size() == steps.size().
[[nodiscard]] std::vector<RangeMm> median_filtered(std::span<const RangeMm> ranges, std::span<const std::int32_t> steps,
                                                   std::int32_t steps_per_turn, int window);

} // namespace scanloom::robot

#pragma once

#include "common/scan/scan.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::robot {

inline constexpr int kMedianWindowMin = 3;
inline constexpr int kMedianWindowMax = 101; ///< beams; 15 and more round corners, 51 and more remove them

/// Replaces each return by the median of itself and its neighbours, the same number on each side: half of `window`, or
/// fewer where the neighbours end, at a beam without a return and at a gap of more than four times the median gap. So
/// no beam becomes a return, no return is lost, and returns are not mixed across unobserved directions.
///
/// @param steps           direction of each beam, increasing, all within one turn; the last and the first beam are
///                        neighbours, too
/// @param steps_per_turn  steps of a full turn
/// @param window          beams; odd, from 1 (no change) to kMedianWindowMax
/// Pre: ranges.size() == steps.size().
[[nodiscard]] std::vector<RangeMm> median_filtered(std::span<const RangeMm> ranges, std::span<const std::int32_t> steps,
                                                   std::int32_t steps_per_turn, int window);

} // namespace scanloom::robot

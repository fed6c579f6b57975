#pragma once

#include "server/planning/passability.hpp"

#include <span>

namespace scanloom::planning {

inline constexpr std::size_t kRegionCornersMax = 4096;

/// Returns the window's cells whose centres are inside a polygon. Where the polygon crosses itself, inside and outside
/// alternate (even-odd rule).
/// @param corners  metres, map frame, clockwise or counter-clockwise; the last one is connected to the first
/// Errors: kInvalidField for fewer than 3 or more than kRegionCornersMax corners, or for a corner that is not finite.
[[nodiscard]] Result<BitGrid> cells_inside(const Passability& passability, std::span<const Point2> corners);

} // namespace scanloom::planning

#pragma once

#include "server/planning/passability.hpp"

#include <span>

namespace scanloom::planning {

inline constexpr std::size_t kRegionCornersMax = 4096;

/// The window's cells whose centres are inside a polygon; where it crosses itself, inside and outside alternate.
/// @param corners  metres, in the map frame, either way round; the last is joined to the first
/// Errors  kInvalidField: fewer than 3 or more than kRegionCornersMax corners, or one that is not finite.
[[nodiscard]] Result<BitGrid> cells_inside(const Passability& passability, std::span<const Point2> corners);

} // namespace scanloom::planning

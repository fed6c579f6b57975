#pragma once

#include "server/planning/passability.hpp"

namespace scanloom::planning {

/// Returns whether a body stays clear of all obstacles while its centre moves along a straight segment.
///
/// The body is clear if its centre stays further than its radius from the square of every obstacle cell
/// (Passability::obstacles) and, with on_known, from the area outside the window. Exact except for rounding; see
/// kRoundingCells. A body of radius 0 is always clear: callers check the cells that its centre crosses.
/// @param from  start of the segment, in cells from the window's lower-left corner
/// @param to    end of the segment, in the same unit; may be equal to `from`
[[nodiscard]] bool keeps_clear(const Passability& passability, const Point2& from, const Point2& to);

} // namespace scanloom::planning

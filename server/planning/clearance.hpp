#pragma once

#include "server/planning/passability.hpp"

namespace scanloom::planning {

/// Whether a body whose centre goes straight from one point to another (which may be the same) stays further than its
/// radius from the square of every obstacle (Passability::obstacles, and with on_known what is beyond the window).
/// Exact but for rounding, see kRoundingCells.
/// A body without extent always does: the cells that its centre goes through are others' concern.
/// Points are in cells from the window's lower-left corner.
[[nodiscard]] bool keeps_clear(const Passability& passability, const Point2& from, const Point2& to);

} // namespace scanloom::planning

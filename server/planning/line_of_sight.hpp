#pragma once

#include "server/planning/passability.hpp"

#include <optional>

namespace scanloom::planning {

/// What the straight way between two points costs, in cells; nothing when it touches a cell that may not be entered,
/// be it at a corner. Along the border of two cells it costs what the dearer one does.
/// Points are in cells from the window's lower-left corner.
///
/// Pre     both points are in cells that may be entered.
/// Source  Amanatides, Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (Eurographics 1987).
[[nodiscard]] std::optional<double> cost_of_line(const Passability& passability, const Point2& from, const Point2& to);

} // namespace scanloom::planning

#pragma once

#include "server/planning/passability.hpp"

#include <optional>

namespace scanloom::planning {

/// Returns the cost of the straight segment between two points, in cells, or nullopt if it touches a cell that cannot
/// be entered, even only at a corner.
///
/// Along the border between two cells the segment costs what the more expensive cell costs.
/// @param from  in cells from the window's lower-left corner
/// @param to    in the same unit
/// Precondition: both points are in cells that can be entered.
/// Source: Amanatides, Woo, A Fast Voxel Traversal Algorithm for Ray Tracing (Eurographics 1987).
[[nodiscard]] std::optional<double> cost_of_line(const Passability& passability, const Point2& from, const Point2& to);

} // namespace scanloom::planning

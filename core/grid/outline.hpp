#pragma once

#include "core/grid/cell.hpp"

#include <vector>

namespace scanloom::grid {

/// A closed line along the borders of cells: the corners where it turns, with the first one repeated at the end. Corner
/// (i, j) is the lower left corner of cell (i, j).
using Ring = std::vector<Cell>;

/// An area of cells connected by their sides: the outer ring counter-clockwise, then the holes clockwise.
using Outline = std::vector<Ring>;

/// Returns the areas that cells cover, as valid polygons of RFC 7946 and of simple features: two areas touch at corners
/// only, and so do the rings of one area. The areas are ordered by their first cells, by rows.
/// @param cells  each once, in any order; at least one cell away from the ends of the int32 range
[[nodiscard]] std::vector<Outline> outlines_of(std::vector<Cell> cells);

} // namespace scanloom::grid

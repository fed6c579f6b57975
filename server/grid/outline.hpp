#pragma once

#include "server/grid/cell.hpp"

#include <vector>

namespace scanloom::grid {

/// A closed line along borders of cells: the corners where it turns, the first once more at the end. Corner (i, j) is
/// the lower left one of cell (i, j).
using Ring = std::vector<Cell>;

/// An area of cells that hang together by their sides: its outer ring counter-clockwise, then its holes, clockwise.
using Outline = std::vector<Ring>;

/// The areas that cells cover, as polygons of RFC 7946 and of simple features: two of them touch in corners only, and
/// so do the rings of one. By their first cells, by rows.
/// @param cells  each once, in any order; at least one cell from the ends of the int32 range
[[nodiscard]] std::vector<Outline> outlines_of(std::vector<Cell> cells);

} // namespace scanloom::grid

#pragma once

#include "common/error/error.hpp"
#include "server/grid/cell.hpp"

namespace scanloom::tiles {

/// A rectangle in the map frame. Metres.
struct Extent {
    double min_x = 0.0;
    double min_y = 0.0;
    double max_x = 0.0;
    double max_y = 0.0;

    friend bool operator==(const Extent&, const Extent&) = default;
};

/// Returns the rectangle that a box of cells covers.
/// Precondition: the box is not empty.
[[nodiscard]] Extent extent_of(const grid::CellBox& cells, double cell_size_m) noexcept;

/// Returns the rectangle that the tiles of a session cover: the square at zoom 0 of the tile pyramid.
[[nodiscard]] Extent tiled_extent(double cell_size_m) noexcept;

/// Returns the cells that a rectangle overlaps. An edge within a millionth of a cell of a cell border counts as on the
/// border, so that rounding of decimal metres does not add a cell.
/// Errors: kInvalidField if the rectangle is not finite, is empty, or lies outside the range of cell indices.
[[nodiscard]] Result<grid::CellBox> cells_in(const Extent& extent, double cell_size_m);

} // namespace scanloom::tiles

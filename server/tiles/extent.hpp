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

/// What a box of cells covers. Pre: the box is not empty.
[[nodiscard]] Extent extent_of(const grid::CellBox& cells, double cell_size_m) noexcept;

/// What the tiles of a session cover: the square S of the tile pyramid.
[[nodiscard]] Extent tiled_extent(double cell_size_m) noexcept;

/// The cells that a rectangle overlaps. An edge within a millionth of a cell of a cell border lies on it, so that
/// decimal metres name the cells that they seem to.
/// Errors  kInvalidField: not finite, empty, or beyond where cells can be numbered.
[[nodiscard]] Result<grid::CellBox> cells_in(const Extent& extent, double cell_size_m);

} // namespace scanloom::tiles

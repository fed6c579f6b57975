#pragma once

#include "common/error/error.hpp"
#include "core/classify/cell_class.hpp"

#include <vector>

namespace scanloom::planning {

/// The distance to the nearest obstacle for each cell of a window.
struct DistanceField {
    grid::CellBox window;
    std::vector<float> metres; ///< by rows from the bottom; 0 in an occupied cell; infinity if the window has none

    /// Returns the distance of a cell, in metres.
    /// Precondition: the window contains the cell.
    [[nodiscard]] float at(grid::Cell cell) const noexcept {
        return metres[static_cast<std::size_t>((cell.j - std::int64_t{window.j_begin}) * window.width() +
                                               (cell.i - std::int64_t{window.i_begin}))];
    }
};

/// Computes the Euclidean distance of each cell's centre to the centre of the nearest OCCUPIED cell of the window,
/// exact up to the rounding of a float.
/// @param cell_size_m  metres
/// @param window       cells to compute; only obstacles in it count
/// Errors: kTooLarge if the window has more than kSearchCellsMax cells (search_window.hpp).
/// Source: Felzenszwalb, Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing 8 (2012).
[[nodiscard]] Result<DistanceField> distance_field(const classify::ClassView& classes, double cell_size_m,
                                                   const grid::CellBox& window);

} // namespace scanloom::planning

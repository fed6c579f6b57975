#pragma once

#include "common/error/error.hpp"
#include "server/classify/cell_class.hpp"

#include <vector>

namespace scanloom::planning {

/// How far the nearest obstacle is, for each cell of a window.
struct DistanceField {
    grid::CellBox window;
    std::vector<float> metres; ///< by rows from the bottom; 0 in an occupied cell, infinite when there is none

    /// Pre  the window holds the cell.
    [[nodiscard]] float at(grid::Cell cell) const noexcept {
        return metres[static_cast<std::size_t>((cell.j - std::int64_t{window.j_begin}) * window.width() +
                                               (cell.i - std::int64_t{window.i_begin}))];
    }
};

/// The Euclidean distance of each cell's centre to that of the nearest OCCUPIED cell of the window, exact up to the
/// rounding of a float.
/// Errors  kTooLarge: a window of more than kSearchCellsMax cells (search_window.hpp).
/// Source  Felzenszwalb, Huttenlocher, Distance Transforms of Sampled Functions, Theory of Computing 8 (2012).
[[nodiscard]] Result<DistanceField> distance_field(const classify::ClassView& classes, double cell_size_m,
                                                   const grid::CellBox& window);

} // namespace scanloom::planning

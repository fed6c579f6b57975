#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point2.hpp"
#include "core/classify/cell_class.hpp"

#include <cstdint>
#include <span>

namespace scanloom::planning {

inline constexpr std::int64_t kWindowCellsMax = std::int64_t{1} << 28; ///< a BitGrid of this size takes 32 MiB
inline constexpr std::int64_t kSearchCellsMax = std::int64_t{1} << 26; ///< a search of this many cells takes 512 MiB

/// The properties of a body that determine a search window.
struct Reach {
    double body_radius_m = 0.0; ///< metres
    bool allow_unknown = false; ///< unexplored cells can be entered
};

/// Returns the cell that contains a point.
/// @param point        metres, map frame
/// @param cell_size_m  metres
/// Errors: kInvalidField if the point is not finite or outside the range of cell numbers.
[[nodiscard]] Result<grid::Cell> numbered_cell(const Point2& point, double cell_size_m);

/// The part of a map that a search depends on.
struct SearchWindow {
    grid::CellBox box;             ///< whole chunks
    std::int64_t search_cells = 0; ///< cells a search can reach, in whole chunks; most of the box may be unexplored
};

/// Computes the window of a search.
///
/// Explored chunks form one area if they touch, at least at a corner, or if a body would touch both sides of the gap
/// between them. The box contains whole areas:
/// - Without ends: all areas.
/// - On explored ground: the area around the first end. No path leads into another area.
/// - With allow_unknown: the areas around all ends, the ends themselves, one more chunk on every side, and every area
///   that this larger box touches. So the box contains a path around everything in it.
///
/// Therefore a stray scan far away does not enlarge the window.
/// @param classes      of the map
/// @param cell_size_m  metres
/// @param reach        what can be entered, and how near areas must be to count as one
/// @param ends         metres, map frame: the start of a path, then its possible goals
/// @return the window; its box is {0, 0, 0, 0} if nothing is explored around the first end
/// Errors: kTooLarge if the box has more than kWindowCellsMax cells or more than kSearchCellsMax must be searched;
///     kInvalidField as numbered_cell().
[[nodiscard]] Result<SearchWindow> search_window(const classify::ClassView& classes, double cell_size_m,
                                                 const Reach& reach, std::span<const Point2> ends = {});

} // namespace scanloom::planning

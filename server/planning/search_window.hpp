#pragma once

#include "common/error/error.hpp"
#include "common/geometry/point2.hpp"
#include "server/classify/cell_class.hpp"

#include <cstdint>
#include <span>

namespace scanloom::planning {

inline constexpr std::int64_t kWindowCellsMax = std::int64_t{1} << 28; ///< a BitGrid of it takes 32 MiB
inline constexpr std::int64_t kSearchCellsMax = std::int64_t{1} << 26; ///< a search of so many cells takes 512 MiB

/// What a search needs to know of a body.
struct Reach {
    double body_radius_m = 0.0;
    bool allow_unknown = false; ///< may unexplored cells be entered?
};

/// The cell that holds a point.
/// @param point  metres, map frame
/// Errors  kInvalidField: not finite, or beyond where cells are numbered.
[[nodiscard]] Result<grid::Cell> numbered_cell(const Point2& point, double cell_size_m);

/// The part of a map that decides a search.
struct SearchWindow {
    grid::CellBox box;             ///< whole chunks
    std::int64_t search_cells = 0; ///< to which a search may come, in whole chunks: most of the box may be unexplored
};

/// The window of a search. Explored chunks are one area where they touch, at
/// least at a corner, or where a body would touch both sides of what is between them; the box holds whole areas:
///   no ends: all of them;
///   on explored ground: the one around the first end. No way leads into another;
///   allow_unknown: those around all ends and the ends themselves, a chunk more on every side, and whatever area that
///   box touches, so that a way around everything within lies in the box.
/// What one stray scan left far away therefore does not count.
/// @param ends  metres, map frame: where a way begins, then where it may lead
/// @return its box is {0, 0, 0, 0} where nothing is explored around the first end
/// Errors  kTooLarge: more than kWindowCellsMax cells in the box, or more than kSearchCellsMax to be searched.
///         kInvalidField: see numbered_cell().
[[nodiscard]] Result<SearchWindow> search_window(const classify::ClassView& classes, double cell_size_m,
                                                 const Reach& reach, std::span<const Point2> ends = {});

} // namespace scanloom::planning

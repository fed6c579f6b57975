#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "core/classify/cell_class.hpp"
#include "core/planning/bit_grid.hpp"
#include "core/planning/search_window.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace scanloom::planning {

inline constexpr double kDangerCostMax = 1000.0; ///< of PassabilityOptions::danger_cost

/// Tolerance of radii, in cells: a radius of three cells reaches the third cell even if the quotient of two decimal
/// fractions was rounded.
inline constexpr double kRoundingCells = 1e-9;

/// The body that moves, and where it may go.
struct PassabilityOptions {
    double body_radius_m = 0.15; ///< 0: the body is a point
    double danger_cost = 1.0;    ///< additional cost of a metre in danger
    bool allow_unknown = false;  ///< unexplored cells, also frontiers, can be entered at the cost of free ones
    bool on_known = false;       ///< the whole body must be on known ground: unexplored cells may hide walls
};

/// Where a body can be in a part of the map, and what it costs to move there.
///
/// The body is a disc; its position is that of its centre. A cell can be entered if it is free (in danger or not; with
/// allow_unknown also if it is unexplored) and no occupied cell's square is within the body's radius of its centre.
/// With on_known, no square of any other cell that is not ground, and no point outside the window, may be within the
/// radius either. If a diagonal step between two such centres would come nearer to an obstacle than the radius, a
/// radius larger by up to 0.17 cells applies. A metre in a DANGER cell costs 1 + danger_cost, any other metre 1. Spots
/// are cells of the window; see search_window().
struct Passability {
    grid::CellBox window;       ///< cells of the map that the grids below describe
    double cell_size_m = 0.0;   ///< metres
    PassabilityOptions options; ///< what it was computed for
    BitGrid occupied;           ///< OCCUPIED
    BitGrid ground;    ///< where a point can be: FREE and DANGER; with allow_unknown every cell that is not OCCUPIED
    BitGrid danger;    ///< DANGER
    BitGrid obstacles; ///< what the body keeps clear of: OCCUPIED; with on_known every cell that is not ground
    BitGrid fits;      ///< where the body's centre can be: the ground that is far enough from the obstacles
    BitGrid enterable; ///< `fits` and the cells that open_start() opens

    /// Returns the cell of the map that a place in the window denotes.
    [[nodiscard]] grid::Cell cell_at(Spot spot) const noexcept {
        return {window.i_begin + spot.x, window.j_begin + spot.y};
    }
    /// Returns the centre of a cell in metres of the map frame.
    /// @param spot  a cell of the window
    /// @return metres, map frame
    [[nodiscard]] Point2 centre_of(Spot spot) const noexcept {
        const grid::Cell cell = cell_at(spot);
        return {(cell.i + 0.5) * cell_size_m, (cell.j + 0.5) * cell_size_m};
    }
    /// Returns the cell's place in the window, or nullopt if the cell is outside.
    /// @param cell  any cell of the map
    [[nodiscard]] std::optional<Spot> spot_of(grid::Cell cell) const noexcept;
    /// Returns the place in the window of the cell that contains a point, or nullopt if the point is outside the
    /// window.
    /// @param point  metres, map frame
    [[nodiscard]] std::optional<Spot> spot_at(const Point2& point) const noexcept;
};

/// Converts a point from metres of the map frame to cells from the window's lower-left corner.
/// @param passability  its window and cell size are used
/// @param point        metres, map frame
/// @param cell         the cell that contains the point; the result lies within it even if the difference was rounded
/// @return cells from the window's lower-left corner
[[nodiscard]] Point2 to_cells(const Passability& passability, const Point2& point, Spot cell);

/// Computes the passability of the search_window() of `ends`.
/// @param classes      of the map
/// @param cell_size_m  metres
/// @param options      body, costs, and whether unexplored cells can be entered
/// @param ends         metres, map frame: the start of a path, then its possible goals; empty: all explored ground
/// Errors: kInvalidField for an option out of range or a point that is not finite; kTooLarge if the window is too large
///     (see search_window()).
[[nodiscard]] Result<Passability> make_passability(const classify::ClassView& classes, double cell_size_m,
                                                   const PassabilityOptions& options,
                                                   std::span<const Point2> ends = {});

/// Makes a path's start usable and returns its cell.
///
/// If the start's cell is unknown but known ground lies within the body's radius, the unknown cells under the body
/// become ground, because the body covers them. If the cell is free but nearer to an obstacle than the body radius (a
/// robot got there and must be able to leave), more cells can be entered from then on: the free cells that are
/// connected to it, within a body radius and a cell of it, and no nearer to an occupied cell than it is. With on_known,
/// this includes cells up to four times as far away that lead to known ground on all sides, because a laser that looks
/// ahead shows a robot no ground at its own sides.
/// @param passability  changed if the start is not usable as it is
/// @param start        metres, map frame
/// @return the start's cell, in the window
/// Errors: kNoPath if the start is outside the map, inside an obstacle or in unknown space; kInvalidField if it is not
///     finite.
[[nodiscard]] Result<Spot> open_start(Passability& passability, const Point2& start);

/// Checks that a path can end at a point and returns the point's cell.
/// @param passability  of the search
/// @param goal         metres, map frame
/// @return the goal's cell, in the window
/// Errors: kNoPath if the goal is outside the map, inside an obstacle or in unknown space, or if the point or its
///     cell's centre is nearer to an obstacle than the body radius; kInvalidField if it is not finite.
[[nodiscard]] Result<Spot> check_goal(const Passability& passability, const Point2& goal);

/// Returns how many columns a disc reaches to either side in its middle row and each row above, for dilated().
/// @param radius     cells
/// @param to_square  whether the distance is measured from a cell's centre to the nearest point of the disc's centre
///     cell, instead of to that cell's centre; the disc reaches cells at a distance of at most `radius`
[[nodiscard]] std::vector<std::int32_t> disc_half_widths(double radius, bool to_square);

} // namespace scanloom::planning

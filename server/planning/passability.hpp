#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"
#include "server/classify/cell_class.hpp"
#include "server/planning/bit_grid.hpp"
#include "server/planning/search_window.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace scanloom::planning {

inline constexpr double kDangerCostMax = 1000.0;

/// A radius of three cells shall reach the third cell, however the quotient of two decimal fractions was rounded.
inline constexpr double kRoundingCells = 1e-9;

struct PassabilityOptions {
    double body_radius_m = 0.15; ///< 0: a point
    double danger_cost = 1.0;    ///< what a metre in danger costs more than another
    bool allow_unknown = false;  ///< may unexplored cells (frontiers, too) be entered? They cost what free ones do
    bool on_known = false;       ///< must the whole body be on known ground? Unexplored cells may hide walls
};

/// What of a map a body may enter, and what it costs.
///
/// The body is a disc; where it is, its centre is. A cell may be entered when it is free (in danger or not; with
/// allow_unknown unexplored, too) and no occupied cell's square is within the body's radius of its centre; with
/// on_known no other cell's that is not ground, or beyond the window. (Where a diagonal step between such centres would
/// come nearer, the radius counts as up to 0.17 cells more.) A metre in a DANGER cell costs 1 + danger_cost, any
/// other 1. Spots are cells of the window: see search_window().
struct Passability {
    grid::CellBox window;
    double cell_size_m = 0.0;
    PassabilityOptions options;
    BitGrid occupied;
    BitGrid ground;    ///< where a point may be: FREE and DANGER; with allow_unknown, all that is not OCCUPIED
    BitGrid danger;    ///< DANGER
    BitGrid obstacles; ///< what the body keeps its radius from: OCCUPIED; with on_known, all that is not ground
    BitGrid fits;      ///< where the body's centre may be: the ground that is far enough from the obstacles
    BitGrid enterable; ///< those, and the way out that open_start() allows

    [[nodiscard]] grid::Cell cell_at(Spot spot) const noexcept {
        return {window.i_begin + spot.x, window.j_begin + spot.y};
    }
    /// Metres, in the map frame.
    [[nodiscard]] Point2 centre_of(Spot spot) const noexcept {
        const grid::Cell cell = cell_at(spot);
        return {(cell.i + 0.5) * cell_size_m, (cell.j + 0.5) * cell_size_m};
    }
    [[nodiscard]] std::optional<Spot> spot_of(grid::Cell cell) const noexcept;
    /// The cell that holds a point, unless it is outside the window.
    [[nodiscard]] std::optional<Spot> spot_at(const Point2& point) const noexcept;
};

/// Metres of the map frame to cells from the window's lower-left corner; within the cell that holds the point, however
/// the difference was rounded.
[[nodiscard]] Point2 to_cells(const Passability& passability, const Point2& point, Spot cell);

/// @param ends  metres, map frame: where a way begins, then where it may lead; none: all that is explored
/// Errors  kInvalidField: an option out of its range, a point that is not finite.
///         kTooLarge: see search_window().
[[nodiscard]] Result<Passability> make_passability(const classify::ClassView& classes, double cell_size_m,
                                                   const PassabilityOptions& options,
                                                   std::span<const Point2> ends = {});

/// Where a path may begin: the point's cell. When that is free but nearer to an obstacle than the body radius (a
/// robot got there somehow, and must be able to leave), the free cells that hang together with it within a body
/// radius and a cell of it, and are no nearer to an occupied one, may be entered from now on; with on_known also those
/// further away that lead to known ground all around, up to four times as far. (A laser that looks ahead shows a robot
/// no ground beside itself.) Known ground within the body's radius makes ground of what is unknown there, too: the body
/// covers it.
///
/// Errors  kNoPath: outside the map, inside an obstacle, in unknown space. kInvalidField: not finite.
[[nodiscard]] Result<Spot> open_start(Passability& passability, const Point2& start);

/// Where a path may end: the point's cell.
/// Errors  kNoPath: as above, or the point or its cell's centre is nearer to an obstacle than the body radius.
/// kInvalidField: not finite.
[[nodiscard]] Result<Spot> check_goal(const Passability& passability, const Point2& goal);

/// The columns that a disc reaches to either side, in its middle row and those above: for dilated().
/// A cell is within reach when the distance of its centre to the disc's centre (`to_square`: to the nearest point of
/// the disc's cell) is at most the radius. In cells.
[[nodiscard]] std::vector<std::int32_t> disc_half_widths(double radius, bool to_square);

} // namespace scanloom::planning

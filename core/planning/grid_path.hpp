#pragma once

#include "core/planning/cost_search.hpp"

#include <vector>

namespace scanloom::planning {

/// A path through the map, in metres of the map frame.
struct Path {
    std::vector<Point2> points; ///< from the start to the goal, connected by straight segments
    double length_m = 0.0;      ///< metres, of the polyline
    double cost = 0.0;          ///< metres; each metre in danger counts 1 + danger_cost
};

/// Whether the corners of a path stay where the search put them.
enum class Shape {
    kStraightened, ///< without corners wherever a straight segment is as safe and costs no more
    kSteps,        ///< the steps of the search, from centre to centre
};

/// Plans the cheapest path from one point to another.
///
/// Of all sequences of steps from cell to cell, the path is the one of least cost (CostSearch). It is then
/// straightened, which only makes it cheaper. In open space, steps in eight directions are up to 8 % longer than a
/// straight line; straightening may not remove all of that.
///
/// Every cell that the path touches can be entered. After the path has left the cells that open_start() opened, the
/// body's centre stays at least the body radius from the square of every obstacle (Passability::obstacles); within the
/// goal's cell, with a tolerance of a twentieth of a cell.
/// @param classes      of the map
/// @param cell_size_m  metres
/// @param start        metres, map frame
/// @param goal         metres, map frame
/// @param options      body, costs, and whether unexplored cells can be entered
/// @param shape        whether to straighten the path
/// Errors: kNoPath if the start or the goal is outside the map, inside an obstacle or in unknown space (unless that is
///     allowed), if the goal is nearer to an obstacle than the body radius (the start may be; see open_start()), or if
///     no path connects them; kInvalidField for an invalid option or a point that is not finite; kTooLarge if the map
///     is too large (see search_window()).
/// Source: see CostSearch for the search and cost_of_line() for the straightening.
[[nodiscard]] Result<Path> plan_path(const classify::ClassView& classes, double cell_size_m, const Point2& start,
                                     const Point2& goal, const PassabilityOptions& options = {},
                                     Shape shape = Shape::kStraightened);

/// Converts the cells that a search found into a path.
/// @param passability  of the search
/// @param cells        adjacent cells, at least one
/// @param start        first point of the path, in the first cell; metres, map frame
/// @param goal         last point of the path, in the last cell; metres, map frame
/// @param shape        whether to straighten the path
[[nodiscard]] Path to_path(const Passability& passability, const std::vector<Spot>& cells, const Point2& start,
                           const Point2& goal, Shape shape);

} // namespace scanloom::planning

#pragma once

#include "server/planning/cost_search.hpp"

#include <vector>

namespace scanloom::planning {

/// A way through the map. Metres, in the map frame.
struct Path {
    std::vector<Point2> points; ///< first the start, last the goal; straight between them
    double length_m = 0.0;
    double cost = 0.0; ///< length_m, metres in danger counting 1 + danger_cost
};

enum class Shape {
    kStraightened, ///< corners left out wherever the straight way is as safe and costs no more
    kSteps,        ///< the search's own steps, from centre to centre
};

/// The cheapest way from one point to another: of all sequences of steps from cell to cell (CostSearch) that of least
/// cost, and then straightened, which only makes it cheaper. In the open steps in eight directions are up to 8 % longer
/// than a straight line; what of that straightening cannot mend remains.
/// Every cell that the way touches may be entered. It keeps the body's radius from the square of every obstacle
/// (Passability::obstacles), once it has left what open_start() opened; within the goal's cell to a twentieth of a
/// cell.
///
/// Errors  kNoPath: the start or the goal is outside the map, inside an obstacle, in unknown space (unless that is
///         allowed); the goal is nearer to an obstacle than the body radius (the start may be: see open_start());
///         there is no way between them. kInvalidField: an option, or a point that is not finite. kTooLarge: the map.
[[nodiscard]] Result<Path> plan_path(const classify::ClassView& classes, double cell_size_m, const Point2& start,
                                     const Point2& goal, const PassabilityOptions& options = {},
                                     Shape shape = Shape::kStraightened);

/// The way along cells that a search found, from its first point to its last; both are in the cells at the ends.
[[nodiscard]] Path to_path(const Passability& passability, const std::vector<Spot>& cells, const Point2& start,
                           const Point2& goal, Shape shape);

} // namespace scanloom::planning

#pragma once

#include "server/classify/frontiers.hpp"
#include "server/planning/grid_path.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::planning {

struct ExplorationOptions {
    PassabilityOptions passability; ///< allow_unknown, on_known do not matter: a robot explores from known ground
    std::optional<std::size_t> frontier_size_min; ///< cells; none: see frontier_size_min()
    double standoff_m = 1.0;                      ///< a frontier counts as reachable from so far away; at least 8 cells
};

/// Of how many cells a frontier must be to be worth a goal. By default a frontier narrower than the body counts for
/// nothing, as the body would not get through: it is as long as the body is wide when it has
/// 2 body_radius / (sqrt(2) cell_size) cells, slanted ones being the longest. At least 1.
[[nodiscard]] std::size_t frontier_size_min(const ExplorationOptions& options, double cell_size_m);

/// Where a robot should stand to explore a frontier.
struct FrontierGoal {
    std::size_t frontier = 0; ///< its place among the frontiers
    grid::Cell cell;          ///< to stand in
    grid::Cell target;        ///< the frontier's cell nearest to it
    bool in_danger = false;   ///< there was no other place
    double cost = 0.0;        ///< of the way there, as Path::cost
    double length_m = 0.0;    ///< of the same way, before it is straightened
};

/// One for each frontier; nothing for a frontier that the robot cannot reach.
using FrontierGoals = std::vector<std::optional<FrontierGoal>>;

/// The goals of one robot: for each frontier the cell nearest to it that can be reached, sees it, and is free and not
/// in danger; of equally near ones the one with the cheapest way from the robot. Nearness counts steps over free ground
/// from the frontier. A cell sees a frontier when no occupied one is on the straight line to the frontier's cell
/// nearest to it (one cell for each step along the longer axis): what a robot would go there for.
/// Where all cells near a frontier are in danger, the nearest of those is taken: the way may lead through danger, so
/// standing there is no worse, and a passage as narrow as the danger along its walls would never be explored.
/// The whole body keeps to known ground on the way and at the goal, as walls may begin wherever that ends. Only a robot
/// that has unknown ground under its body already, and no goal otherwise, may go on over it.
/// Pre     the frontiers are those of the classes.
/// Errors  those of plan_path() that concern its start, its options or the map.
[[nodiscard]] Result<FrontierGoals> frontier_goals(const classify::ClassView& classes, double cell_size_m,
                                                   std::span<const classify::Frontier> frontiers, const Point2& robot,
                                                   const ExplorationOptions& options = {});

/// Gives each robot a frontier, no two of them the same: again and again, of all robots without one and frontiers not
/// taken, the pair whose way costs least; of equal ones that of the first robot, then of the first frontier.
/// @param goals  of each robot
/// @param taken  which frontiers others have already; empty: none
/// @return for each robot the place of its frontier, or nothing when none is left that it can reach.
[[nodiscard]] std::vector<std::optional<std::size_t>> assign_frontiers(std::span<const FrontierGoals> goals,
                                                                       std::vector<bool> taken = {});

enum class Exploration {
    kGoal,          ///< there is somewhere to go
    kTakenByOthers, ///< other robots have all frontiers that this one can reach
    kComplete,      ///< no frontier that counts can be reached: the map is complete
};

struct NextGoal {
    Exploration outcome = Exploration::kComplete;
    std::optional<FrontierGoal> goal;      ///< with kGoal
    Path path;                             ///< with kGoal: to the centre of the goal's cell
    std::vector<grid::Cell> around_target; ///< with kGoal: the frontier's cells within standoff_m of the target
    std::size_t given_up = 0;              ///< how many cells did not count
};

/// What a robot should explore next: the frontier with the cheapest way to its goal, of those that no other robot
/// has. Ask again whenever the map has changed.
/// @param targets_of_others  FrontierGoal::target of the goals that other robots pursue: each takes the frontier that
///                           the cell belongs to, or else the nearest one within standoff_m: the map may have
///                           changed since.
/// @param given_up  FRONTIER cells that count for nothing, as they were looked at in vain: see seen_in_vain(). What is
///                  left of their frontiers counts as frontiers of its own.
/// Errors  as frontier_goals().
[[nodiscard]] Result<NextGoal> next_goal(const classify::ClassView& classes, double cell_size_m, const Point2& robot,
                                         std::span<const grid::Cell> targets_of_others = {},
                                         const ExplorationOptions& options = {},
                                         std::span<const grid::Cell> given_up = {});

/// What a robot that has stood at a goal and looked at its target has looked at in vain: the cells around the target
/// that are still FRONTIER and that the goal's cell sees, as above. Whoever leaves them out from now on comes to an
/// end: unless the map around the goal changed, the target is one of them.
/// @param around_target  NextGoal::around_target as it was given; the classes may have changed since.
[[nodiscard]] std::vector<grid::Cell> seen_in_vain(const classify::ClassView& classes, grid::Cell goal,
                                                   std::span<const grid::Cell> around_target);

/// Those of some cells that are FRONTIER, in the same order.
[[nodiscard]] std::vector<grid::Cell> still_frontier(const classify::ClassView& classes,
                                                     std::span<const grid::Cell> cells);

} // namespace scanloom::planning

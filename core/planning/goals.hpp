#pragma once

#include "core/classify/frontiers.hpp"
#include "core/planning/grid_path.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace scanloom::planning {

/// Options of frontier_goals() and next_goal().
struct ExplorationOptions {
    PassabilityOptions passability; ///< allow_unknown and on_known are ignored: a robot explores from known ground
    std::optional<std::size_t> frontier_size_min; ///< cells; nullopt: see frontier_size_min()
    double standoff_m = 1.0;                      ///< metres from which a frontier counts as reached; at least 8 cells
};

/// Returns the number of cells that a frontier needs to be worth a goal.
///
/// By default a frontier narrower than the body is ignored, because the body would not get through. A frontier is as
/// long as the body is wide if it has 2 body_radius / (sqrt(2) cell_size) cells; diagonal frontiers are the longest for
/// their number of cells. The result is at least 1.
/// @param options      body radius, or a fixed number of cells
/// @param cell_size_m  metres
[[nodiscard]] std::size_t frontier_size_min(const ExplorationOptions& options, double cell_size_m);

/// A cell from which a robot can explore a frontier.
struct FrontierGoal {
    std::size_t frontier = 0; ///< index of the frontier
    grid::Cell cell;          ///< where the robot should stand
    grid::Cell target;        ///< the frontier's cell nearest to `cell`
    bool in_danger = false;   ///< `cell` is in danger, because no other cell was found
    double cost = 0.0;        ///< of the path to the cell, as Path::cost
    double length_m = 0.0;    ///< of the same path before it is straightened, metres
};

/// One goal for each frontier; nullopt for a frontier that the robot cannot reach.
using FrontierGoals = std::vector<std::optional<FrontierGoal>>;

/// Returns the goals of one robot.
///
/// The goal of a frontier is the nearest cell that can be reached, sees the frontier, and is free and not in danger; of
/// equally near cells the one with the cheapest path from the robot. The distance to the frontier is counted in steps
/// over free ground. A cell sees a frontier if no cell on the straight line to the frontier's nearest cell is occupied
/// (one cell for each step along the longer axis): the robot goes there to observe the frontier.
///
/// If all cells near a frontier are in danger, the nearest of them is the goal. Paths may lead through danger, so
/// standing there is no worse, and otherwise a passage as narrow as the danger along its walls would never be explored.
/// On the path and at the goal the whole body stays on known ground, because walls may begin wherever known ground
/// ends. Only a robot that already has unknown ground under its body, and otherwise no goal, may cross unknown ground.
/// @param classes      of the map
/// @param cell_size_m  metres
/// @param frontiers    of find_frontiers(); FrontierGoal::frontier is an index of these
/// @param robot        position of the robot, metres, map frame
/// @param options      body and costs
/// Precondition: `frontiers` are the frontiers of `classes`.
/// Errors: those of plan_path() that concern its start, its options or the map.
/// Source: Yamauchi, A Frontier-Based Approach for Autonomous Exploration (1997): the nearest frontier by path cost.
[[nodiscard]] Result<FrontierGoals> frontier_goals(const classify::ClassView& classes, double cell_size_m,
                                                   std::span<const classify::Frontier> frontiers, const Point2& robot,
                                                   const ExplorationOptions& options = {});

/// Assigns a different frontier to each robot.
///
/// Repeatedly takes, of all robots without a frontier and all frontiers not taken, the pair with the cheapest path; of
/// equal pairs that of the first robot, then of the first frontier.
/// @param goals  the goals of each robot
/// @param taken  which frontiers are taken already; empty: none
/// @return for each robot the index of its frontier, or nullopt if none is left that it can reach
/// Source: Burgard, Moors, Stachniss, Schneider, Coordinated Multi-Robot Exploration (2005), with path costs alone.
[[nodiscard]] std::vector<std::optional<std::size_t>> assign_frontiers(std::span<const FrontierGoals> goals,
                                                                       std::vector<bool> taken = {});

/// Whether a robot has something to explore.
enum class Exploration {
    kGoal,          ///< the robot has a goal
    kTakenByOthers, ///< other robots pursue all frontiers that this one can reach
    kComplete,      ///< no frontier that is large enough can be reached: the map is complete
};

/// What a robot should explore next.
struct NextGoal {
    Exploration outcome = Exploration::kComplete; ///< decides which of the other members are set
    std::optional<FrontierGoal> goal;             ///< with kGoal
    Path path;                                    ///< with kGoal: to the centre of the goal's cell
    std::vector<grid::Cell> around_target;        ///< with kGoal: the frontier's cells within standoff_m of the target
    std::size_t given_up = 0;                     ///< number of cells that were excluded
};

/// Returns what a robot should explore next: of the frontiers that no other robot pursues, the one with the cheapest
/// path to its goal. Call it again whenever the map has changed.
/// @param classes            of the map
/// @param cell_size_m        metres
/// @param robot              position of the robot, metres, map frame
/// @param targets_of_others  FrontierGoal::target of the goals that other robots pursue. Each takes the frontier that
///     contains the cell or, as the map may have changed since, the nearest frontier within standoff_m.
/// @param options            body, costs and distances
/// @param given_up           FRONTIER cells to exclude, because they could not be observed; see unobservable_cells().
///     The remaining cells of their frontiers form frontiers of their own.
/// Errors: those of frontier_goals().
[[nodiscard]] Result<NextGoal> next_goal(const classify::ClassView& classes, double cell_size_m, const Point2& robot,
                                         std::span<const grid::Cell> targets_of_others = {},
                                         const ExplorationOptions& options = {},
                                         std::span<const grid::Cell> given_up = {});

/// Returns the cells that a robot could not observe although it stood at the goal and looked at its target.
///
/// These are the cells around the target that are still FRONTIER and visible from the goal's cell, as defined by
/// frontier_goals(). The target is one of them unless the map around the goal has changed. If the caller excludes them
/// from then on, exploration ends.
/// @param classes        the current classes; may have changed since the goal was assigned
/// @param goal           FrontierGoal::cell of the goal
/// @param around_target  NextGoal::around_target of the goal
[[nodiscard]] std::vector<grid::Cell> unobservable_cells(const classify::ClassView& classes, grid::Cell goal,
                                                         std::span<const grid::Cell> around_target);

/// Returns those of `cells` that are FRONTIER, in the same order.
/// @param classes  of the map
/// @param cells    any cells
[[nodiscard]] std::vector<grid::Cell> still_frontier(const classify::ClassView& classes,
                                                     std::span<const grid::Cell> cells);

} // namespace scanloom::planning

#include "core/planning/goals.hpp"

#include "core/planning/goal_seeker.hpp"
#include "core/planning/line_of_sight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <iterator>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

namespace scanloom::planning {
namespace {

using classify::CellClass;
using classify::ClassView;
using classify::Frontier;

constexpr double kStandoffMax = 100.0;        // metres
constexpr std::int32_t kStandoffCellsMin = 8; // with coarse cells, danger alone may be this wide

Result<std::int32_t> standoff_cells(const ExplorationOptions& options, double cell_size_m) {
    if (!(options.standoff_m >= 0.0 && options.standoff_m <= kStandoffMax)) {
        return Error{Errc::kInvalidField,
                     fmt::format("standoff is {} m; it must be 0 .. {}", options.standoff_m, kStandoffMax)};
    }
    return std::max(static_cast<std::int32_t>(options.standoff_m / cell_size_m), kStandoffCellsMin);
}

/// Returns the cells of the frontier within `reach_cells` of the target.
std::vector<grid::Cell> cells_around(grid::Cell target, const Frontier& frontier, std::int32_t reach_cells) {
    const double reach = reach_cells;
    std::vector<grid::Cell> near;
    std::ranges::copy_if(frontier.cells, std::back_inserter(near),
                         [&](grid::Cell cell) { return square_of_distance(cell, target) <= reach * reach; });
    return near;
}

/// The ground around a robot, and the cost from the robot's position to every cell.
struct Surroundings {
    Passability passability;
    CostSearch search;
    bool hemmed_in; // the body fits at the robot's position only thanks to open_start()

    Surroundings(Passability ground, Spot start, bool start_opened)
        : passability(std::move(ground)), search(passability), hemmed_in(start_opened) {
        search.from(start);
    }
    Surroundings(const Surroundings&) = delete; // the search holds the passability's address
    Surroundings& operator=(const Surroundings&) = delete;
};

/// Returns which of the first `counting` frontiers, those that are large enough, the other robots' targets take. A
/// target in a smaller frontier takes none. A target that is in no frontier any more takes the nearest large enough
/// one.
std::vector<bool> taken_frontiers(std::span<const Frontier> frontiers, std::size_t counting,
                                  std::span<const grid::Cell> targets, std::int32_t reach_cells) {
    std::vector<bool> taken(frontiers.size());
    for (const grid::Cell target : targets) {
        std::optional<std::size_t> nearest;
        double least = static_cast<double>(reach_cells) * reach_cells;
        for (std::size_t place = 0; place < frontiers.size(); ++place) {
            const double distance = square_of_distance(nearest_cell(frontiers[place], target), target);
            const bool may_be = place < counting || distance == 0.0;
            if (!may_be || distance > least || (nearest && distance == least)) continue;
            nearest = place;
            least = distance;
        }
        if (nearest) taken[*nearest] = true;
    }
    taken.resize(counting);
    return taken;
}

Result<std::unique_ptr<Surroundings>> survey(const ClassView& classes, double cell_size_m, const Point2& robot,
                                             PassabilityOptions options, bool on_known) {
    options.allow_unknown = false;
    options.on_known = on_known;
    auto passability = make_passability(classes, cell_size_m, options, {&robot, 1});
    if (!passability) return passability.error();
    const auto place = passability->spot_at(robot);
    const bool fits = place && passability->enterable.test(*place);
    const auto start = open_start(*passability, robot);
    if (!start) return start.error();
    return std::make_unique<Surroundings>(std::move(*passability), *start, !fits);
}

FrontierGoals goals_from(const Surroundings& surroundings, std::span<const Frontier> frontiers, std::int32_t rings) {
    GoalSeeker seeker(surroundings.passability, surroundings.search, rings);
    FrontierGoals goals;
    for (std::size_t place = 0; place < frontiers.size(); ++place)
        goals.push_back(seeker.seek(frontiers[place], place));
    return goals;
}

bool any_of(const FrontierGoals& goals) {
    return std::ranges::any_of(goals, [](const auto& goal) { return goal.has_value(); });
}

/// The goals of a robot, and the search that found the paths there.
struct Survey {
    std::unique_ptr<Surroundings> surroundings;
    FrontierGoals goals;
};

/// Searches over known ground only. If the robot sees too little known ground to leave its position, searches again
/// over all free ground.
Result<Survey> survey_goals(const ClassView& classes, double cell_size_m, std::span<const Frontier> frontiers,
                            const Point2& robot, const ExplorationOptions& options, std::int32_t rings) {
    auto careful = survey(classes, cell_size_m, robot, options.passability, true);
    if (!careful) return careful.error();
    auto goals = goals_from(**careful, frontiers, rings);
    if (any_of(goals) || !(*careful)->hemmed_in) return Survey{std::move(*careful), std::move(goals)};
    careful->reset(); // a search takes much memory
    auto bold = survey(classes, cell_size_m, robot, options.passability, false);
    if (!bold) return bold.error();
    goals = goals_from(**bold, frontiers, rings);
    return Survey{std::move(*bold), std::move(goals)};
}

} // namespace

std::size_t frontier_size_min(const ExplorationOptions& options, double cell_size_m) {
    if (options.frontier_size_min) return *options.frontier_size_min;
    const double cells = 2.0 * options.passability.body_radius_m / (std::numbers::sqrt2 * cell_size_m);
    return cells >= 1.0 && cells < 1e9 ? static_cast<std::size_t>(cells) : 1;
}

Result<FrontierGoals> frontier_goals(const ClassView& classes, double cell_size_m, std::span<const Frontier> frontiers,
                                     const Point2& robot, const ExplorationOptions& options) {
    const auto rings = standoff_cells(options, cell_size_m);
    if (!rings) return rings.error();
    auto found = survey_goals(classes, cell_size_m, frontiers, robot, options, *rings);
    if (!found) return found.error();
    return std::move(found->goals);
}

std::vector<std::optional<std::size_t>> assign_frontiers(std::span<const FrontierGoals> goals,
                                                         std::vector<bool> taken) {
    struct Pair {
        double cost;
        std::size_t robot;
        std::size_t frontier;
        auto operator<=>(const Pair&) const = default;
    };
    std::vector<Pair> cheapest_first;
    for (std::size_t robot = 0; robot < goals.size(); ++robot) {
        for (const auto& goal : goals[robot]) {
            if (goal) cheapest_first.push_back({goal->cost, robot, goal->frontier});
        }
        taken.resize(std::max(taken.size(), goals[robot].size()));
    }
    std::ranges::sort(cheapest_first);
    std::vector<std::optional<std::size_t>> assigned(goals.size());
    for (const Pair& pair : cheapest_first) {
        if (assigned[pair.robot] || taken[pair.frontier]) continue;
        assigned[pair.robot] = pair.frontier;
        taken[pair.frontier] = true;
    }
    return assigned;
}

Result<NextGoal> next_goal(const ClassView& classes, double cell_size_m, const Point2& robot,
                           std::span<const grid::Cell> targets_of_others, const ExplorationOptions& options,
                           std::span<const grid::Cell> given_up) {
    const auto rings = standoff_cells(options, cell_size_m);
    if (!rings) return rings.error();
    auto frontiers = classify::find_frontiers(classes, 1, given_up);
    const std::size_t size_min = frontier_size_min(options, cell_size_m);
    const auto too_small = [&](const Frontier& frontier) { return frontier.cells.size() < size_min; };
    const auto counting = std::ranges::find_if(frontiers, too_small); // the largest frontiers come first
    auto taken =
        taken_frontiers(frontiers, static_cast<std::size_t>(counting - frontiers.begin()), targets_of_others, *rings);
    frontiers.erase(counting, frontiers.end());
    const auto found = survey_goals(classes, cell_size_m, frontiers, robot, options, *rings);
    if (!found) return found.error();
    const Surroundings& surroundings = *found->surroundings;
    const Passability& passability = surroundings.passability;
    const FrontierGoals& goals = found->goals;
    NextGoal next{Exploration::kComplete, std::nullopt, {}, {}, given_up.size()};
    if (!any_of(goals)) return next;
    const auto assigned = assign_frontiers({&goals, 1}, std::move(taken)).front();
    next.outcome = Exploration::kTakenByOthers;
    if (!assigned) return next;
    next.outcome = Exploration::kGoal;
    next.goal = goals[*assigned];
    const Spot spot = *passability.spot_of(next.goal->cell);
    next.path = to_path(passability, surroundings.search.path_to(spot), robot, passability.centre_of(spot),
                        Shape::kStraightened);
    next.around_target = cells_around(next.goal->target, frontiers[*assigned], *rings);
    return next;
}

std::vector<grid::Cell> still_frontier(const ClassView& classes, std::span<const grid::Cell> cells) {
    std::vector<grid::Cell> still;
    std::ranges::copy_if(cells, std::back_inserter(still),
                         [&](grid::Cell cell) { return classify::class_at(classes, cell) == CellClass::kFrontier; });
    return still;
}

std::vector<grid::Cell> unobservable_cells(const ClassView& classes, grid::Cell goal,
                                           std::span<const grid::Cell> around_target) {
    auto cells = still_frontier(classes, around_target);
    const auto is_occupied = [&](grid::Cell cell) { return classify::class_at(classes, cell) == CellClass::kOccupied; };
    std::erase_if(cells, [&](grid::Cell cell) { return !sees(goal, cell, is_occupied); });
    return cells;
}

} // namespace scanloom::planning

#include "server/planning/goals.hpp"

#include "server/planning/sight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
constexpr std::int32_t kStandoffCellsMin = 8; // coarse cells: danger alone may be as wide

Result<std::int32_t> standoff_cells(const ExplorationOptions& options, double cell_size_m) {
    if (!(options.standoff_m >= 0.0 && options.standoff_m <= kStandoffMax)) {
        return Error{Errc::kInvalidField,
                     fmt::format("standoff is {} m; it must be 0 .. {}", options.standoff_m, kStandoffMax)};
    }
    return std::max(static_cast<std::int32_t>(options.standoff_m / cell_size_m), kStandoffCellsMin);
}

double square_of_distance(grid::Cell a, grid::Cell b) {
    const double di = static_cast<double>(a.i) - b.i;
    const double dj = static_cast<double>(a.j) - b.j;
    return di * di + dj * dj;
}

/// The cell of the frontier nearest to another cell; of equally near ones the first.
grid::Cell nearest_cell(const Frontier& frontier, grid::Cell to) {
    return *std::ranges::min_element(frontier.cells, {}, [&](grid::Cell cell) { return square_of_distance(cell, to); });
}

/// The cells of the frontier within reach of one of them.
std::vector<grid::Cell> cells_around(grid::Cell target, const Frontier& frontier, std::int32_t reach_cells) {
    const double reach = reach_cells;
    std::vector<grid::Cell> near;
    std::ranges::copy_if(frontier.cells, std::back_inserter(near),
                         [&](grid::Cell cell) { return square_of_distance(cell, target) <= reach * reach; });
    return near;
}

/// A robot's place, and what it costs to get from there to anywhere.
struct Surroundings {
    Passability passability;
    CostSearch search;

    explicit Surroundings(Passability ground) : passability(std::move(ground)), search(passability) {}
    Surroundings(const Surroundings&) = delete; // the search knows where the passability is
    Surroundings& operator=(const Surroundings&) = delete;
};

/// Looks for goals around frontiers, ring after ring of free cells.
class GoalSeeker {
public:
    GoalSeeker(const Surroundings& surroundings, std::int32_t rings)
        : passability_(surroundings.passability), search_(surroundings.search), rings_(rings),
          seen_(passability_.ground.width(), passability_.ground.height()) {}

    [[nodiscard]] std::optional<FrontierGoal> seek(const Frontier& frontier, std::size_t place) {
        std::vector<Spot> ring = beside(frontier);
        std::vector<Spot> all_seen = ring;
        std::optional<Spot> fallback;
        std::optional<Spot> best;
        for (std::int32_t step = 1; step <= rings_ && !ring.empty(); ++step) {
            best = cheapest(ring, false, frontier);
            if (best) break;
            if (!fallback) fallback = cheapest(ring, true, frontier);
            ring = around(ring);
            all_seen.insert(all_seen.end(), ring.begin(), ring.end());
        }
        for (const Spot spot : all_seen) seen_.clear(spot);
        if (!best) best = fallback;
        if (!best) return std::nullopt;
        return goal_at(*best, frontier, place);
    }

private:
    /// The free cells among the 8 around each cell of the frontier: they are what makes it one.
    [[nodiscard]] std::vector<Spot> beside(const Frontier& frontier) {
        std::vector<Spot> ring;
        for (const grid::Cell cell : frontier.cells) {
            for (std::int32_t dj = -1; dj <= 1; ++dj) {
                for (std::int32_t di = -1; di <= 1; ++di) {
                    const auto spot = passability_.spot_of({cell.i + di, cell.j + dj});
                    if (spot) add(*spot, ring);
                }
            }
        }
        return ring;
    }

    /// The free cells beside a ring's, not seen yet. Straight steps: they pass no wall, be it one cell thin and
    /// slanted.
    [[nodiscard]] std::vector<Spot> around(const std::vector<Spot>& ring) {
        std::vector<Spot> next;
        for (const Spot at : ring) {
            for (const Spot beside :
                 {Spot{at.x + 1, at.y}, Spot{at.x - 1, at.y}, Spot{at.x, at.y + 1}, Spot{at.x, at.y - 1}}) {
                add(beside, next);
            }
        }
        return next;
    }

    void add(Spot spot, std::vector<Spot>& ring) {
        if (!passability_.ground.test(spot) || seen_.test(spot)) return;
        seen_.set(spot);
        ring.push_back(spot);
    }

    /// Of those that see the frontier.
    [[nodiscard]] std::optional<Spot> cheapest(const std::vector<Spot>& ring, bool in_danger,
                                               const Frontier& frontier) const {
        std::optional<Spot> best;
        double least = std::numeric_limits<double>::infinity();
        for (const Spot spot : ring) {
            if (passability_.danger.test(spot) != in_danger) continue;
            const double cost = search_.cost(spot);
            const bool before = best && (spot.y < best->y || (spot.y == best->y && spot.x < best->x));
            if (cost > least || (cost == least && !before) || std::isinf(cost)) continue;
            const auto target = passability_.spot_of(nearest_cell(frontier, passability_.cell_at(spot)));
            if (target && !sees(spot, *target)) continue;
            best = spot;
            least = cost;
        }
        return best;
    }

    [[nodiscard]] bool sees(Spot from, Spot to) const {
        return planning::sees({from.x, from.y}, {to.x, to.y}, [&](grid::Cell at) {
            return passability_.occupied.test({at.i, at.j});
        });
    }

    [[nodiscard]] FrontierGoal goal_at(Spot spot, const Frontier& frontier, std::size_t place) const {
        const grid::Cell cell = passability_.cell_at(spot);
        const auto path = search_.path_to(spot);
        double length = 0.0; // cells
        for (std::size_t at = 0; at + 1 < path.size(); ++at) {
            length += std::hypot(path[at + 1].x - path[at].x, path[at + 1].y - path[at].y);
        }
        return {place,
                cell,
                nearest_cell(frontier, cell),
                passability_.danger.test(spot),
                search_.cost(spot) * passability_.cell_size_m,
                length * passability_.cell_size_m};
    }

    const Passability& passability_;
    const CostSearch& search_;
    std::int32_t rings_;
    BitGrid seen_;
};

/// Which frontiers the others' targets take.
std::vector<bool> taken_frontiers(std::span<const Frontier> frontiers, std::span<const grid::Cell> targets,
                                  std::int32_t reach_cells) {
    std::vector<bool> taken(frontiers.size());
    for (const grid::Cell target : targets) {
        std::optional<std::size_t> nearest;
        double least = static_cast<double>(reach_cells) * reach_cells;
        for (std::size_t place = 0; place < frontiers.size(); ++place) {
            const double distance = square_of_distance(nearest_cell(frontiers[place], target), target);
            if (distance > least || (nearest && distance == least)) continue;
            nearest = place;
            least = distance;
        }
        if (nearest) taken[*nearest] = true;
    }
    return taken;
}

Result<std::unique_ptr<Surroundings>> survey(const ClassView& classes, double cell_size_m, const Point2& robot,
                                             PassabilityOptions options) {
    options.allow_unknown = false;
    auto passability = make_passability(classes, cell_size_m, options);
    if (!passability) return passability.error();
    const auto start = open_start(*passability, robot);
    if (!start) return start.error();
    auto surroundings = std::make_unique<Surroundings>(std::move(*passability));
    surroundings->search.from(*start);
    return surroundings;
}

FrontierGoals goals_from(const Surroundings& surroundings, std::span<const Frontier> frontiers, std::int32_t rings) {
    GoalSeeker seeker(surroundings, rings);
    FrontierGoals goals;
    for (std::size_t place = 0; place < frontiers.size(); ++place)
        goals.push_back(seeker.seek(frontiers[place], place));
    return goals;
}

} // namespace

std::size_t frontier_size_min(const ExplorationOptions& options, double cell_size_m) {
    if (options.frontier_size_min) return *options.frontier_size_min;
    const double cells = 2.0 * options.passability.body_radius_m / (std::numbers::sqrt2 * cell_size_m);
    return cells >= 1.0 ? static_cast<std::size_t>(cells) : 1;
}

Result<FrontierGoals> frontier_goals(const ClassView& classes, double cell_size_m, std::span<const Frontier> frontiers,
                                     const Point2& robot, const ExplorationOptions& options) {
    const auto rings = standoff_cells(options, cell_size_m);
    if (!rings) return rings.error();
    const auto surroundings = survey(classes, cell_size_m, robot, options.passability);
    if (!surroundings) return surroundings.error();
    return goals_from(**surroundings, frontiers, *rings);
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
    const auto surroundings = survey(classes, cell_size_m, robot, options.passability);
    if (!surroundings) return surroundings.error();
    const auto& [passability, search] = **surroundings;
    const auto frontiers = classify::find_frontiers(classes, frontier_size_min(options, cell_size_m), given_up);
    const FrontierGoals goals = goals_from(**surroundings, frontiers, *rings);
    const bool any = std::ranges::any_of(goals, [](const auto& goal) { return goal.has_value(); });
    NextGoal next{Exploration::kComplete, std::nullopt, {}, {}, given_up.size()};
    if (!any) return next;
    const auto assigned = assign_frontiers({&goals, 1}, taken_frontiers(frontiers, targets_of_others, *rings)).front();
    next.outcome = Exploration::kTakenByOthers;
    if (!assigned) return next;
    next.outcome = Exploration::kGoal;
    next.goal = goals[*assigned];
    const Spot spot = *passability.spot_of(next.goal->cell);
    next.path = to_path(passability, search.path_to(spot), robot, passability.centre_of(spot), Shape::kStraightened);
    next.around_target = cells_around(next.goal->target, frontiers[*assigned], *rings);
    return next;
}

std::vector<grid::Cell> still_frontier(const ClassView& classes, std::span<const grid::Cell> cells) {
    std::vector<grid::Cell> still;
    std::ranges::copy_if(cells, std::back_inserter(still),
                         [&](grid::Cell cell) { return classify::class_at(classes, cell) == CellClass::kFrontier; });
    return still;
}

std::vector<grid::Cell> seen_in_vain(const ClassView& classes, grid::Cell goal,
                                     std::span<const grid::Cell> around_target) {
    auto cells = still_frontier(classes, around_target);
    const auto is_occupied = [&](grid::Cell cell) { return classify::class_at(classes, cell) == CellClass::kOccupied; };
    std::erase_if(cells, [&](grid::Cell cell) { return !sees(goal, cell, is_occupied); });
    return cells;
}

} // namespace scanloom::planning

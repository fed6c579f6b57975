#include "core/planning/cost_search.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace scanloom::planning {
namespace {

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr double kDiagonal = std::numbers::sqrt2;
constexpr int kHere = 4; // of the 3 x 3 cells around a cell, by rows from the bottom

constexpr Spot step_of(int direction) { return {direction % 3 - 1, direction / 3 - 1}; }

constexpr bool is_diagonal(int direction) { return direction != kHere && direction % 2 == 0; }

/// Returns the possible steps, one bit for each direction, by which of the 3 x 3 cells can be entered.
constexpr std::array<std::uint16_t, 512> possible_steps() {
    std::array<std::uint16_t, 512> table{};
    for (std::uint32_t enterable = 0; enterable < table.size(); ++enterable) {
        for (int direction = 0; direction < 9; ++direction) {
            const Spot step = step_of(direction);
            std::uint32_t needed = 1U << direction;
            if (is_diagonal(direction)) needed |= 1U << (kHere + step.x) | 1U << (kHere + 3 * step.y);
            if (direction != kHere && (enterable & needed) == needed) {
                table[enterable] = static_cast<std::uint16_t>(table[enterable] | 1U << direction);
            }
        }
    }
    return table;
}

constexpr auto kPossibleSteps = possible_steps();

constexpr std::uint32_t kAll = (1U << 9) - 1;

/// Returns the steps worth taking from a cell whose neighbours all cost the same, by the step that led to it. The
/// predecessor reaches any other neighbour as cheaply without this cell, taking the diagonal step first. So only one of
/// several equally cheap paths is followed.
/// Source: the natural neighbours of Harabor, Grastien, Online Graph Pruning for Pathfinding on Grid Maps (AAAI 2011).
constexpr std::array<std::uint16_t, 9> natural_steps() {
    std::array<std::uint16_t, 9> table{};
    for (int came = 0; came < 9; ++came) {
        const Spot step = step_of(came);
        std::uint32_t steps = 1U << came;
        if (is_diagonal(came)) steps |= 1U << (kHere + step.x) | 1U << (kHere + 3 * step.y);
        table[static_cast<std::size_t>(came)] = static_cast<std::uint16_t>(came == kHere ? kAll : steps);
    }
    return table;
}

constexpr auto kNaturalSteps = natural_steps();

/// Calls visit(direction) for each of the steps.
template <class Visit>
void for_each_step(std::uint32_t steps, Visit&& visit) {
    for (; steps != 0; steps &= steps - 1) visit(std::countr_zero(steps));
}

Spot moved(Spot from, int direction) {
    const Spot step = step_of(direction);
    return {from.x + step.x, from.y + step.y};
}

/// Returns the cost between two cells without obstacles, a lower bound of the true cost.
double without_obstacles(Spot from, Spot to) {
    const int dx = std::abs(from.x - to.x);
    const int dy = std::abs(from.y - to.y);
    return std::max(dx, dy) + (kDiagonal - 1.0) * std::min(dx, dy);
}

/// Aims of a search; see CostSearch::search(). A step's cost minus the decrease of the estimate is never less than the
/// width of a bucket.
struct Everything {
    static constexpr double kBucketWidth = 0.5;
    [[nodiscard]] double estimate(Spot) const { return 0.0; }
    [[nodiscard]] bool take(Spot, double) const { return true; }
    [[nodiscard]] bool done(double) const { return false; }
};

struct Towards {
    static constexpr double kTrust = 0.95; // weight of the estimate: with 1, straight steps would stay in their bucket
    static constexpr double kBucketWidth = 1.0 - kTrust;
    Spot goal;
    const CostSearch& search;

    [[nodiscard]] double estimate(Spot spot) const { return kTrust * without_obstacles(spot, goal); }
    [[nodiscard]] bool take(Spot, double) const { return true; }
    [[nodiscard]] bool done(double bound) const { return search.cost(goal) <= bound; }
};

struct Nearest {
    static constexpr double kBucketWidth = Everything::kBucketWidth;
    const BitGrid& wanted;
    std::optional<Spot> found = std::nullopt;
    double found_cost = kUnreached;

    [[nodiscard]] double estimate(Spot) const { return 0.0; }
    [[nodiscard]] bool take(Spot spot, double cost) {
        if (cost > found_cost) return false;
        if (!wanted.test(spot)) return true;
        const bool before = !found || spot.y < found->y || (spot.y == found->y && spot.x < found->x);
        if (cost < found_cost || before) found = spot;
        found_cost = cost;
        return false;
    }
    [[nodiscard]] bool done(double) const { return found.has_value(); }
};

} // namespace

CostSearch::CostSearch(const Passability& passability)
    : passability_(&passability), blocks_wide_(static_cast<std::uint32_t>(passability.enterable.width()) / kBlockSide),
      blocks_(std::size_t{blocks_wide_} * static_cast<std::uint32_t>(passability.enterable.height()) / kBlockSide) {
    for (int direction = 0; direction < 9; ++direction) {
        const auto place = static_cast<std::size_t>(direction);
        for (int dangers = 0; dangers <= 2; ++dangers) {
            step_costs_[static_cast<std::size_t>(dangers)][place] =
                (is_diagonal(direction) ? kDiagonal : 1.0) * (1.0 + 0.5 * dangers * passability.options.danger_cost);
        }
    }
    const double farthest = 2.0 * kDiagonal + kDiagonal * passability.options.danger_cost; // one step and its estimate
    buckets_.resize(std::bit_ceil(static_cast<std::size_t>(farthest / Towards::kBucketWidth) + 3));
}

/// Returns the cost of a cell for writing; allocates the cell's block if necessary.
double& CostSearch::cost_of(std::uint32_t cell) {
    auto& block = blocks_[cell / kBlockCells];
    if (!block) {
        block = std::make_unique_for_overwrite<Block>();
        block->fill(kUnreached);
        reached_.push_back(cell / kBlockCells);
    }
    return (*block)[cell % kBlockCells];
}

void CostSearch::begin(Spot start) {
    for (const std::uint32_t block : reached_) blocks_[block].reset();
    reached_.clear();
    for (auto& bucket : buckets_) bucket.clear();
    cost_of(index_of(start)) = 0.0;
}

/// Takes the open cells bucket by bucket, ordered by their cost plus the remaining cost that `aim` estimates.
///
/// No step stays within a bucket, so all costs in the first bucket are final, in whatever order its cells are taken.
/// `aim` receives each cell taken and decides whether to expand it. It also decides when to stop, given a bound below
/// which no open cell can cost.
template <class Aim>
void CostSearch::search(Spot start, Aim& aim) {
    begin(start);
    constexpr double kBucketsPerCell = 1.0 / Aim::kBucketWidth;
    const std::size_t mask = buckets_.size() - 1;
    auto current = static_cast<std::size_t>(aim.estimate(start) * kBucketsPerCell);
    buckets_[current & mask].push_back({0.0, index_of(start), kHere});
    std::size_t open = 1;
    const auto reach = [&](Spot spot, double cost, std::uint32_t came) {
        const std::uint32_t cell = index_of(spot);
        double& least = cost_of(cell);
        if (cost >= least) return;
        least = cost;
        const auto place = static_cast<std::size_t>((cost + aim.estimate(spot)) * kBucketsPerCell);
        buckets_[std::max(place, current) & mask].push_back({cost, cell, came}); // max: for rounding
        ++open;
    };
    for (; open > 0; ++current) {
        auto& bucket = buckets_[current & mask];
        while (!bucket.empty()) {
            const Open taken = bucket.back();
            bucket.pop_back();
            --open;
            if (taken.cost > cost_of(taken.cell)) continue; // a cheaper path was found since
            const Spot at = spot_of(taken.cell);
            if (aim.take(at, taken.cost)) expand(at, taken, reach);
        }
        if (aim.done(static_cast<double>(current + 1) * Aim::kBucketWidth)) return;
    }
}

/// Calls reach(Spot, cost, step) for each neighbour to which a step from the cell is possible and worthwhile.
template <class Reach>
void CostSearch::expand(Spot at, const Open& taken, Reach& reach) const {
    const std::uint32_t danger = passability_->danger.around(at);
    const auto* costs = step_costs_.data() + (danger >> kHere & 1);
    const std::uint32_t around = passability_->enterable.around(at);
    std::uint32_t steps = kPossibleSteps[around];
    if (around == kAll && (danger == 0 || danger == kAll)) steps &= kNaturalSteps[taken.came];
    for_each_step(steps, [&](int direction) {
        const double step = costs[danger >> direction & 1][static_cast<std::size_t>(direction)];
        reach(moved(at, direction), taken.cost + step, static_cast<std::uint32_t>(direction));
    });
}

void CostSearch::from(Spot start) {
    Everything everything;
    search(start, everything);
}

void CostSearch::between(Spot start, Spot goal) {
    Towards towards{goal, *this};
    search(start, towards);
    assert(cost(goal) < kUnreached);
}

std::optional<Spot> CostSearch::nearest(Spot start, const BitGrid& wanted) {
    Nearest nearest{wanted};
    search(start, nearest);
    return nearest.found;
}

std::vector<Spot> CostSearch::path_to(Spot goal) const {
    assert(cost(goal) < kUnreached);
    std::vector<Spot> path = {goal};
    while (cost(path.back()) > 0.0) {
        const Spot at = path.back();
        const std::uint32_t danger = passability_->danger.around(at);
        Spot best = at;
        double least = kUnreached;
        for_each_step(kPossibleSteps[passability_->enterable.around(at)], [&](int direction) {
            const std::uint32_t dangers = (danger >> kHere & 1) + (danger >> direction & 1);
            const double through =
                cost(moved(at, direction)) + step_costs_[dangers][static_cast<std::size_t>(direction)];
            if (through >= least) return;
            best = moved(at, direction);
            least = through;
        });
        path.push_back(best);
    }
    std::ranges::reverse(path);
    return path;
}

} // namespace scanloom::planning

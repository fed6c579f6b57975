#pragma once

#include "server/planning/cost_search.hpp"
#include "server/planning/goals.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanloom::planning {

[[nodiscard]] double square_of_distance(grid::Cell a, grid::Cell b) noexcept;

/// The cell of the frontier nearest to another cell; of equally near ones the first.
[[nodiscard]] grid::Cell nearest_cell(const classify::Frontier& frontier, grid::Cell to);

/// Looks for goals around frontiers, ring after ring of free cells: see frontier_goals().
class GoalSeeker {
public:
    /// Both must outlive the seeker; the search tells what it costs the robot to get anywhere.
    /// @param rings  how many to look at
    GoalSeeker(const Passability& passability, const CostSearch& search, std::int32_t rings);

    /// Nothing where the robot can get to no place for it.
    /// @param place  of the frontier among all
    [[nodiscard]] std::optional<FrontierGoal> seek(const classify::Frontier& frontier, std::size_t place);

private:
    [[nodiscard]] std::vector<Spot> beside(const classify::Frontier& frontier);
    [[nodiscard]] std::vector<Spot> around(const std::vector<Spot>& ring);
    void add(Spot spot, std::vector<Spot>& ring);
    [[nodiscard]] std::optional<Spot> cheapest(const std::vector<Spot>& ring, bool in_danger,
                                               const classify::Frontier& frontier) const;
    [[nodiscard]] bool sees(Spot from, Spot to) const;
    [[nodiscard]] FrontierGoal goal_at(Spot spot, const classify::Frontier& frontier, std::size_t place) const;

    const Passability& passability_;
    const CostSearch& search_;
    std::int32_t rings_;
    BitGrid seen_;
};

} // namespace scanloom::planning

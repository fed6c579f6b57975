#pragma once

#include "core/planning/cost_search.hpp"
#include "core/planning/goals.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace scanloom::planning {

/// Returns the squared distance between two cells, in cells squared.
[[nodiscard]] double square_of_distance(grid::Cell a, grid::Cell b) noexcept;

/// Returns the frontier's cell nearest to `to`; of equally near ones the first by rows.
/// @param frontier  not empty
/// @param to        any cell
[[nodiscard]] grid::Cell nearest_cell(const classify::Frontier& frontier, grid::Cell to);

/// Searches for the goal of a frontier, ring after ring of free cells around it; see frontier_goals().
class GoalSeeker {
public:
    /// Keeps references to both, which must outlive the seeker.
    /// @param passability  of the map that the frontiers are from
    /// @param search       holds the cost from the robot to every cell
    /// @param rings        how many rings to examine
    GoalSeeker(const Passability& passability, const CostSearch& search, std::int32_t rings);

    /// Returns the goal for a frontier, or nullopt if the robot can reach none.
    /// @param frontier  of the same map
    /// @param place     index of the frontier among all frontiers
    [[nodiscard]] std::optional<FrontierGoal> seek(const classify::Frontier& frontier, std::size_t place);

private:
    [[nodiscard]] std::vector<Spot> cells_next_to(const classify::Frontier& frontier);
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

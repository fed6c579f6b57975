#pragma once

#include "server/planning/passability.hpp"

#include <array>
#include <optional>
#include <vector>

namespace scanloom::planning {

/// What it costs to get from one cell to others, from centre to centre, in cells: times the cell size it is metres.
///
/// Steps lead to the 8 cells around; a diagonal one only where both cells beside it may be entered, too, so that no
/// corner is cut. A step costs its length times the mean of what a metre costs in its two cells: half of it lies in
/// either. All costs are exact (up to rounding): the least of any sequence of steps.
/// The same question gets the same answer, to the last bit. Memory: 8 bytes for each cell of the window.
/// Source  Dijkstra (1959); Hart, Nilsson, Raphael (1968); buckets for a queue: Dial, CACM 12 (1969), which may be
///         as wide as the shortest step (Denardo, Fox, Operations Research 27 (1979)).
class CostSearch {
public:
    /// The passability must outlive the search.
    explicit CostSearch(const Passability& passability);
    explicit CostSearch(Passability&&) = delete;

    /// Costs of every cell that can be reached.
    void from(Spot start);

    /// Searches towards the goal only.
    /// Pre  the goal can be reached: connected().
    void between(Spot start, Spot goal);

    /// Searches until the cheapest of some cells is found; of equally cheap ones the first by rows.
    [[nodiscard]] std::optional<Spot> nearest(Spot start, const BitGrid& wanted);

    /// Of the last search; infinite where it did not come.
    [[nodiscard]] double cost(Spot spot) const noexcept { return cost_[index_of(spot)]; }

    /// The cells from the last search's start to a cell that it reached.
    [[nodiscard]] std::vector<Spot> path_to(Spot goal) const;

private:
    struct Open {
        double cost;
        std::uint32_t cell;
        std::uint32_t came; // the step that led to it
    };

    [[nodiscard]] std::uint32_t index_of(Spot spot) const noexcept {
        return static_cast<std::uint32_t>(spot.y) * width_ + static_cast<std::uint32_t>(spot.x);
    }
    [[nodiscard]] Spot spot_of(std::uint32_t cell) const noexcept {
        return {static_cast<std::int32_t>(cell % width_), static_cast<std::int32_t>(cell / width_)};
    }

    void begin(Spot start);
    template <class Aim>
    void search(Spot start, Aim& aim);
    template <class Reach>
    void expand(Spot at, const Open& taken, Reach& reach) const;

    const Passability* passability_;
    std::uint32_t width_;
    std::array<std::array<double, 9>, 3> step_costs_; // by how many of its two cells are in danger, and its direction
    std::vector<double> cost_;
    std::uint32_t lowest_ = 1; // all cells whose cost is not infinite are among lowest_ .. highest_
    std::uint32_t highest_ = 0;
    std::vector<std::vector<Open>> buckets_;
};

} // namespace scanloom::planning

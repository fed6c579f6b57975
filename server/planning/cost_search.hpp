#pragma once

#include "server/planning/passability.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace scanloom::planning {

/// What it costs to get from one cell to others, from centre to centre, in cells: times the cell size it is metres.
///
/// Steps lead to the 8 cells around; a diagonal one only where both cells beside it may be entered, too, so that no
/// corner is cut. A step costs its length times the mean of what a metre costs in its two cells: half of it lies in
/// either. All costs are exact (up to rounding): the least of any sequence of steps.
/// The same question gets the same answer, to the last bit. Memory: 8 bytes for each cell of the chunks reached.
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
    [[nodiscard]] double cost(Spot spot) const noexcept {
        const std::uint32_t cell = index_of(spot);
        const auto& block = blocks_[cell / kBlockCells];
        return block ? (*block)[cell % kBlockCells] : std::numeric_limits<double>::infinity();
    }

    /// The cells from the last search's start to a cell that it reached.
    [[nodiscard]] std::vector<Spot> path_to(Spot goal) const;

private:
    static constexpr std::uint32_t kBlockSide = 64;
    static constexpr std::uint32_t kBlockCells = kBlockSide * kBlockSide;
    using Block = std::array<double, kBlockCells>; // the costs of a square of cells; infinite where none is known

    struct Open {
        double cost;
        std::uint32_t cell;
        std::uint32_t came; // the step that led to it
    };

    /// Block by block.
    [[nodiscard]] std::uint32_t index_of(Spot spot) const noexcept {
        const auto x = static_cast<std::uint32_t>(spot.x);
        const auto y = static_cast<std::uint32_t>(spot.y);
        const std::uint32_t block = y / kBlockSide * blocks_wide_ + x / kBlockSide;
        return block * kBlockCells + y % kBlockSide * kBlockSide + x % kBlockSide;
    }
    [[nodiscard]] Spot spot_of(std::uint32_t cell) const noexcept {
        const std::uint32_t block = cell / kBlockCells;
        const std::uint32_t x = block % blocks_wide_ * kBlockSide + cell % kBlockSide;
        const std::uint32_t y = block / blocks_wide_ * kBlockSide + cell % kBlockCells / kBlockSide;
        return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
    }

    [[nodiscard]] double& cost_of(std::uint32_t cell);
    void begin(Spot start);
    template <class Aim>
    void search(Spot start, Aim& aim);
    template <class Reach>
    void expand(Spot at, const Open& taken, Reach& reach) const;

    const Passability* passability_;
    std::uint32_t blocks_wide_;
    std::array<std::array<double, 9>, 3> step_costs_; // by how many of its two cells are in danger, and its direction
    std::vector<std::unique_ptr<Block>> blocks_;      // by rows; null where the last search did not come
    std::vector<std::uint32_t> reached_;              // the others
    std::vector<std::vector<Open>> buckets_;
};

} // namespace scanloom::planning

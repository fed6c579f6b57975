#pragma once

#include "core/planning/passability.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace scanloom::planning {

/// Finds the cheapest paths between cells, from centre to centre.
///
/// Costs are in cells; multiply by the cell size to get metres. A step leads to one of the 8 neighbours of a cell. A
/// diagonal step is possible only if both cells next to it can be entered, so that no path cuts a corner. A step costs
/// its length times the mean cost per metre of its two cells, because half of it lies in each. Each cost is the minimum
/// over all sequences of steps, exact except for rounding. Equal searches return bit-identical results.
/// Memory: 8 bytes for each cell of the chunks that a search reaches.
/// Source: Dijkstra (1959); Hart, Nilsson, Raphael (1968); buckets as the queue: Dial, CACM 12 (1969); a bucket may be
///     as wide as the shortest step: Denardo, Fox, Operations Research 27 (1979).
class CostSearch {
public:
    /// Keeps a reference to `passability`, which must outlive the search.
    /// @param passability  decides which cells can be entered, and where a metre costs more
    explicit CostSearch(const Passability& passability);
    explicit CostSearch(Passability&&) = delete;

    /// Computes the cost of every cell that can be reached from `start`.
    /// @param start  a cell of the window that can be entered
    void from(Spot start);

    /// Searches until the cost of `goal` is known.
    /// @param start  a cell of the window that can be entered
    /// @param goal   likewise
    /// Precondition: `goal` can be reached from `start`; see connected().
    void between(Spot start, Spot goal);

    /// Searches until the cheapest of the wanted cells is found.
    /// @param start   a cell of the window that can be entered
    /// @param wanted  cells to search for, of the same window
    /// @return the cheapest of them, of equally cheap ones the first by rows; nullopt if none can be reached
    [[nodiscard]] std::optional<Spot> nearest(Spot start, const BitGrid& wanted);

    /// Returns what it costs to get to a cell in the last search; infinity if the search did not reach the cell.
    /// @param spot  a cell of the window
    [[nodiscard]] double cost(Spot spot) const noexcept {
        const std::uint32_t cell = index_of(spot);
        const auto& block = blocks_[cell / kBlockCells];
        return block ? (*block)[cell % kBlockCells] : std::numeric_limits<double>::infinity();
    }

    /// Returns the cells from the last search's start to `goal`, both included.
    /// @param goal  a cell of the window
    /// Precondition: the last search reached `goal`.
    [[nodiscard]] std::vector<Spot> path_to(Spot goal) const;

private:
    static constexpr std::uint32_t kBlockSide = 64;
    static constexpr std::uint32_t kBlockCells = kBlockSide * kBlockSide;
    using Block = std::array<double, kBlockCells>; // costs of a square of cells; infinity: unknown

    struct Open {
        double cost;
        std::uint32_t cell;
        std::uint32_t came; // direction of the step that led to the cell
    };

    /// Returns the index of a cell, numbered block by block.
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
    std::array<std::array<double, 9>, 3> step_costs_; // by number of its cells in danger, direction
    std::vector<std::unique_ptr<Block>> blocks_;      // by rows; null: the last search did not reach it
    std::vector<std::uint32_t> reached_;              // indices of the blocks that are not null
    std::vector<std::vector<Open>> buckets_;
};

} // namespace scanloom::planning

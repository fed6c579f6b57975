#pragma once

#include "common/scan/sensor.hpp"
#include "core/grid/cell.hpp"
#include "sim/ground_truth.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scanloom::lab {

/// A value for each cell of a box, bottom row first.
template <class Value>
struct CellGrid {
    grid::CellBox box;
    std::vector<Value> values;

    CellGrid() = default;
    CellGrid(const grid::CellBox& all, Value value)
        : box(all), values(static_cast<std::size_t>(all.width() * all.height()), value) {}

    [[nodiscard]] bool contains(grid::Cell cell) const noexcept {
        return cell.i >= box.i_begin && cell.i < box.i_end && cell.j >= box.j_begin && cell.j < box.j_end;
    }

    /// Pre: contains(cell).
    [[nodiscard]] Value& at(grid::Cell cell) { return values[index_of(cell)]; }
    [[nodiscard]] const Value& at(grid::Cell cell) const { return values[index_of(cell)]; }

private:
    [[nodiscard]] std::size_t index_of(grid::Cell cell) const noexcept {
        return static_cast<std::size_t>(std::int64_t{cell.j - box.j_begin} * box.width() + (cell.i - box.i_begin));
    }
};

/// A boolean for each cell.
using CellMask = CellGrid<std::uint8_t>;

/// Calls visit(Cell) for every cell of the box, row by row from the bottom.
template <class Visit>
void for_each_cell(const grid::CellBox& box, Visit&& visit) {
    for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
        for (std::int32_t i = box.i_begin; i < box.i_end; ++i) visit(grid::Cell{i, j});
    }
}

/// Returns the cells that a run could see, with perfect beams in all directions between the laser's first and last
/// beam:
///   free      one of the poses has a line of sight to the cell's centre, within range
///   occupied  one of the poses has a line of sight, within range, to a point of a solid's side in the cell;
///             points are 2 cm or a quarter cell apart, whichever is less
/// Walkers hide nothing.
/// Pre: the laser has uniform angles and is mounted at the robot's centre.
[[nodiscard]] CellMask visible_cells(const sim::World& world, const sim::GroundTruthGrid& truth, const Sensor& laser,
                                     std::span<const Pose2> path, const grid::CellBox& box);

/// The state of a cell in a map.
enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

using StateGrid = CellGrid<CellState>;
using GroundTruthCells = CellGrid<sim::GroundTruth>;

/// Where a tolerance applies, a cell within this Chebyshev distance counts as the cell itself.
inline constexpr std::int32_t kTolerance = 1; // cells

/// The quality of a map. A share of nothing is 0.
struct Scores {
    double precision = 0.0; ///< of the map's occupied cells: those with a solid in the cell or next to it
    double recall = 0.0;    ///< of the visible solid cells: those with an occupied cell of the map there or next to it
    double iou = 0.0;       ///< of precision P and recall R: P R / (P + R - P R), the Jaccard index; at most either
    double iou_exact = 0.0; ///< without tolerance: visible solid cells that are occupied in the map, of the visible
                            ///< solid cells and the cells that the map has as occupied outside solids. Solid cells that
                            ///< are not visible do not count.
    double free_recall = 0.0; ///< of the visible free cells that are not next to a solid: those free in the map
    std::size_t occupied = 0; ///< cells occupied in the map
    std::size_t residue = 0;  ///< of these: not at a solid, but where only a walker was

    friend bool operator==(const Scores&, const Scores&) = default;
};

/// Compares a map with the ground truth.
/// Shapes: all arguments have the same box.
/// @param seen    visible cells, see visible_cells(). Other cells are not required, but occupied cells that the map has
///                there count.
/// @param walked  cells where a walker was and no longer is
[[nodiscard]] Scores score(const StateGrid& map, const GroundTruthCells& truth, const CellMask& seen,
                           const CellMask& walked);

} // namespace scanloom::lab

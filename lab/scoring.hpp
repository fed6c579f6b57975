#pragma once

#include "lab/cell_grid.hpp"

#include "robot_client/sim/truth_grid.hpp"

#include <cstddef>

namespace scanloom::lab {

/// The state of a cell in a map.
enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

using StateGrid = CellGrid<CellState>;
using TruthCells = CellGrid<robot::Truth>;

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
[[nodiscard]] Scores score(const StateGrid& map, const TruthCells& truth, const CellMask& seen, const CellMask& walked);

} // namespace scanloom::lab

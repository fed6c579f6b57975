#pragma once

#include "lab/cell_grid.hpp"

#include "robot_client/sim/truth_grid.hpp"

#include <cstddef>

namespace scanloom::lab {

/// What a map says of a cell.
enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

using StateGrid = CellGrid<CellState>;
using TruthCells = CellGrid<robot::Truth>;

/// Neighbours count as the cell itself where a tolerance is granted: Chebyshev distance.
inline constexpr std::int32_t kTolerance = 1; // cells

/// How good a map is. A share of nothing is 0.
struct Scores {
    double precision = 0.0; ///< of the map's occupied cells: a solid in the cell or next to it
    double recall = 0.0;    ///< of the solid cells that could be seen: the map has an occupied one there or next to it
    double iou = 0.0;       ///< of precision P and recall R: P R / (P + R - P R), the Jaccard index; above neither
    double iou_exact = 0.0; ///< without tolerance: solid cells that could be seen and are occupied in the map, of those
                            ///< that could be seen or where the map claims one and none is. Cells within solids that
                            ///< could not be seen are neither right nor wrong.
    double free_recall = 0.0; ///< of the free cells that could be seen and are not next to a solid: free in the map
    std::size_t occupied = 0; ///< cells occupied in the map
    std::size_t residue = 0;  ///< of them: not at a solid, and where only a walker was

    friend bool operator==(const Scores&, const Scores&) = default;
};

/// Compares a map with the truth.
/// Shapes  all of the same box.
///         seen: which cells could be seen, see visible_cells(); what could not is not asked for, but a map that claims
///         occupied cells there is answerable for them.
///         walked: where a walker was, and is not any more.
[[nodiscard]] Scores score(const StateGrid& map, const TruthCells& truth, const CellMask& seen, const CellMask& walked);

} // namespace scanloom::lab

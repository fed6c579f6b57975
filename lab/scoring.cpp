#include "lab/scoring.hpp"

#include <cassert>

namespace scanloom::lab {
namespace {

double share(std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Intersection over union of two sets, from the share of each that agrees: 1 / (1 / precision + 1 / recall - 1).
double jaccard(double precision, double recall) {
    const double product = precision * recall;
    return product == 0.0 ? 0.0 : product / (precision + recall - product);
}

/// Returns the cells within the tolerance of cells with this value.
template <class Value>
CellMask around(const CellGrid<Value>& grid, Value value) {
    CellMask mask(grid.box, 0);
    for_each_cell(grid.box, [&](grid::Cell cell) {
        if (grid.at(cell) != value) return;
        for (std::int32_t j = cell.j - kTolerance; j <= cell.j + kTolerance; ++j) {
            for (std::int32_t i = cell.i - kTolerance; i <= cell.i + kTolerance; ++i) {
                if (mask.contains({i, j})) mask.at({i, j}) = 1;
            }
        }
    });
    return mask;
}

} // namespace

Scores score(const StateGrid& map, const TruthCells& truth, const CellMask& seen, const CellMask& walked) {
    assert(map.box == truth.box && map.box == seen.box && map.box == walked.box);
    const CellMask near_solid = around(truth, robot::Truth::kOccupied);
    const CellMask near_occupied = around(map, CellState::kOccupied);
    Scores scores;
    std::size_t matched = 0;
    std::size_t outside = 0; // not in a solid
    std::size_t surface = 0;
    std::size_t found = 0;
    std::size_t found_exactly = 0;
    std::size_t open = 0;
    std::size_t open_found = 0;
    for_each_cell(map.box, [&](grid::Cell cell) {
        const bool is_occupied = map.at(cell) == CellState::kOccupied;
        const bool is_solid = truth.at(cell) == robot::Truth::kOccupied;
        if (is_occupied) {
            ++scores.occupied;
            matched += near_solid.at(cell);
            outside += !is_solid;
            scores.residue += !near_solid.at(cell) && walked.at(cell);
        }
        if (!seen.at(cell)) return;
        if (is_solid) {
            ++surface;
            found += near_occupied.at(cell);
            found_exactly += is_occupied;
        } else if (truth.at(cell) == robot::Truth::kFree && !near_solid.at(cell)) {
            ++open;
            open_found += map.at(cell) == CellState::kFree;
        }
    });
    scores.precision = share(matched, scores.occupied);
    scores.recall = share(found, surface);
    scores.iou = jaccard(scores.precision, scores.recall);
    scores.iou_exact = share(found_exactly, outside + surface);
    scores.free_recall = share(open_found, open);
    return scores;
}

} // namespace scanloom::lab

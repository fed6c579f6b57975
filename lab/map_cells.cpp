#include "lab/map_cells.hpp"

#include <algorithm>

namespace scanloom::lab {
namespace {

constexpr double kOccupiedFrom = 0.65; // probability
constexpr double kFreeUpTo = 0.35;

} // namespace

LogOddsGrid occupancy_of(const mapping::Snapshot& snapshot, const grid::CellBox& box) {
    LogOddsGrid occupancy(box, mapping::kUnknownLogOdds);
    snapshot.laser.visit(grid::chunks_of(box), 0, [&](grid::ChunkKey at, const mapping::LaserChunk& chunk) {
        const grid::CellBox shared{
            std::max(box.i_begin, at.ci * grid::kChunkSide), std::max(box.j_begin, at.cj * grid::kChunkSide),
            std::min(box.i_end, (at.ci + 1) * grid::kChunkSide), std::min(box.j_end, (at.cj + 1) * grid::kChunkSide)};
        for_each_cell(shared,
                      [&](grid::Cell cell) { occupancy.at(cell) = chunk.occupancy[grid::index_in_chunk(cell)]; });
    });
    return occupancy;
}

StateGrid states_of(const LogOddsGrid& occupancy) {
    const auto occupied_from = mapping::to_fixed(mapping::log_odds_of(kOccupiedFrom));
    const auto free_up_to = mapping::to_fixed(mapping::log_odds_of(kFreeUpTo));
    StateGrid states(occupancy.box, CellState::kUnknown);
    for_each_cell(occupancy.box, [&](grid::Cell cell) {
        const mapping::LogOdds l = occupancy.at(cell);
        if (l == mapping::kUnknownLogOdds) return;
        if (l >= occupied_from) states.at(cell) = CellState::kOccupied;
        if (l <= free_up_to) states.at(cell) = CellState::kFree;
    });
    return states;
}

std::size_t touched_cells(const LogOddsGrid& occupancy) {
    const auto unknown = std::count(occupancy.values.begin(), occupancy.values.end(), mapping::kUnknownLogOdds);
    return occupancy.values.size() - static_cast<std::size_t>(unknown);
}

} // namespace scanloom::lab

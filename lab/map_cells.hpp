#pragma once

#include "lab/scoring.hpp"

#include "server/mapping/snapshot.hpp"

namespace scanloom::lab {

using LogOddsGrid = CellGrid<mapping::LogOdds>;

/// The occupancy of a map in a box, kUnknownLogOdds where no scan reached: all that experiments read of maps.
[[nodiscard]] LogOddsGrid occupancy_of(const mapping::Snapshot& snapshot, const grid::CellBox& box);

/// By the thresholds that classes have by default: occupied from p 0.65, free up to 0.35.
[[nodiscard]] StateGrid states_of(const LogOddsGrid& occupancy);

/// How many cells any scan changed.
[[nodiscard]] std::size_t touched_cells(const LogOddsGrid& occupancy);

} // namespace scanloom::lab

#pragma once

#include "lab/scoring.hpp"

#include "core/mapping/snapshot.hpp"

namespace scanloom::lab {

using LogOddsGrid = CellGrid<mapping::LogOdds>;

/// Returns the occupancy of a map within a box, kUnknownLogOdds where no scan reached. Experiments read nothing else of
/// maps.
[[nodiscard]] LogOddsGrid occupancy_of(const mapping::Snapshot& snapshot, const grid::CellBox& box);

/// Classifies cells by the default thresholds: occupied from p 0.65, free up to 0.35.
[[nodiscard]] StateGrid states_of(const LogOddsGrid& occupancy);

/// Returns how many cells any scan changed.
[[nodiscard]] std::size_t touched_cells(const LogOddsGrid& occupancy);

} // namespace scanloom::lab

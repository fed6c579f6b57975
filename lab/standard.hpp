#pragma once

#include "lab/recording.hpp"
#include "lab/scoring.hpp"

#include "server/mapping/map_config.hpp"

#include <vector>

namespace scanloom::lab {

/// What the maps of all runs along one trajectory, at one cell size, are compared with.
struct Standard {
    TruthCells truth;
    CellMask seen; ///< see visible_cells()
};

/// Returns the standard for the room, with a margin of two metres around it.
[[nodiscard]] Standard make_standard(const std::vector<Pose2>& path, double cell_size_m);

/// Returns the cells where walkers were, as far as scans of them may mark cells, except for their final positions,
/// where the map may show them.
/// Pre: the recording has a scan.
[[nodiscard]] CellMask walked_cells(const Recording& recording, const mapping::MapConfig& config,
                                    const grid::CellBox& box);

} // namespace scanloom::lab

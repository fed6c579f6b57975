#pragma once

#include "lab/recording.hpp"
#include "lab/scoring.hpp"

#include "server/mapping/map_config.hpp"

#include <vector>

namespace scanloom::lab {

/// What the maps of runs along one path, at one cell size, are compared with.
struct Standard {
    TruthCells truth;
    CellMask seen; ///< see visible_cells()
};

/// Of the room, with a margin of two metres around it.
[[nodiscard]] Standard make_standard(const std::vector<Pose2>& path, double cell_size_m);

/// Where walkers were, as far as scans of them may mark cells, but for where they stand in the end: what a map shows
/// there is true. Pre: the recording has a scan.
[[nodiscard]] CellMask walked_cells(const Recording& recording, const mapping::MapConfig& config,
                                    const grid::CellBox& box);

} // namespace scanloom::lab

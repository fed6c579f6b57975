#pragma once

#include "core/planning/grid_path.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace scanloom::planning {

/// Options of plan_coverage().
struct CoverageOptions {
    PassabilityOptions passability; ///< allow_unknown is ignored: only free ground is covered
    std::optional<double>
        spacing_m; ///< metres between rows: at most 2 body radii and a cell; default 2 body radii; 0: every row
    std::vector<Point2> region; ///< corners of a polygon, metres, map frame; empty: no bound
};

/// A check that a long search calls repeatedly. The search stops with the error that the check returns.
using MayGoOn = std::function<Result<>()>;

/// A path that covers all free ground of a region within the search_window() around the start.
struct Coverage {
    Path path;                      ///< from the start
    std::int64_t free_cells = 0;    ///< free cells of the region, in danger or not
    std::int64_t covered_cells = 0; ///< those of them whose centres are within a body radius of the path
    std::vector<grid::Cell>
        unreachable;             ///< the other free cells, by rows: the body can reach no position that covers them
    double unreachable_m2 = 0.0; ///< square metres of `unreachable`
    double fraction = 0.0;       ///< covered_cells / free_cells
};

/// Plans a path that covers a region in parallel rows (boustrophedon).
///
/// The path sweeps block after block of rows, always the block nearest to the end of the previous one. It then visits
/// what the rows left out at their ends and next to obstacles, the nearest first. Each free cell of the region (in
/// danger or not) either has its centre within a body radius of the path or is listed as unreachable. Rows are
/// straight; between rows the path is that of plan_path(), not straightened.
/// @param classes      of the map
/// @param cell_size_m  metres
/// @param start        metres, map frame
/// @param options      region, body and distance of the rows
/// @param may_go_on    called before each connection between rows or places; may be empty
/// Errors: kNoPath if the start is not possible (see plan_path()) or no cell of the region can be reached;
///     kInvalidField for an option or a spacing out of range, or an invalid region; kTooLarge if the map is too large
///     (see search_window()); the errors of `may_go_on`.
/// Source: Choset, Pignon, Coverage Path Planning: The Boustrophedon Cellular Decomposition (1998); see sweep_blocks().
[[nodiscard]] Result<Coverage> plan_coverage(const classify::ClassView& classes, double cell_size_m,
                                             const Point2& start, const CoverageOptions& options = {},
                                             const MayGoOn& may_go_on = {});

} // namespace scanloom::planning

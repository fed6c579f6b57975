#pragma once

#include "server/planning/grid_path.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace scanloom::planning {

struct CoverageOptions {
    PassabilityOptions passability; ///< its allow_unknown does not matter: only free ground is covered
    std::optional<double>
        spacing_m;              ///< between rows: at most 2 body radii and a cell; default 2 body radii; 0: every row
    std::vector<Point2> region; ///< corners of a polygon, metres; none: no bound
};

/// Asked again and again during a long search, which ends with the error that it returns.
using MayGoOn = std::function<Result<>()>;

/// A way over all free ground of a region in the search_window() around the start.
struct Coverage {
    Path path; ///< from the start
    std::int64_t free_cells = 0;
    std::int64_t covered_cells = 0;
    std::vector<grid::Cell>
        unreachable; ///< the other free cells, by rows: no place within reach of them can be entered
    double unreachable_m2 = 0.0;
    double fraction = 0.0; ///< covered_cells of free_cells
};

/// Sweeps a region to and fro, row by row (boustrophedon), each block of rows after the nearest one before; then goes
/// to what was left out at the rows' ends and beside obstacles, the nearest first.
/// Each free cell (in danger or not) of the region has its centre within a body radius of the path, or is listed as
/// unreachable. Rows are straight; between them the way is that of plan_path(), not straightened.
/// Errors  kNoPath: the start cannot be (see plan_path()); no cell of the region can be reached. kInvalidField: an
///         option, a spacing out of its range, a region that is none. kTooLarge: the map. Those of may_go_on.
[[nodiscard]] Result<Coverage> plan_coverage(const classify::ClassView& classes, double cell_size_m,
                                             const Point2& start, const CoverageOptions& options = {},
                                             const MayGoOn& may_go_on = {});

} // namespace scanloom::planning

#pragma once

#include "common/error/error.hpp"
#include "server/mapping/snapshot.hpp"
#include "server/mapping/trajectory.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <functional>
#include <vector>

/// The parts of robots' paths that are in memory no more, which is bounded: what the log tells of them.
namespace scanloom::session {

/// Points of all robots together that are told at once, at most: up to 40 MiB while they are read, and 30 MiB of text
/// that is made of them.
inline constexpr std::size_t kPathPointsMax = std::size_t{1} << 19;

struct OldPaths {
    std::vector<std::vector<mapping::TrajectoryPoint>> robots; ///< by RobotIndex, each by rising revision

    /// With what the trajectories keep, the paths are whole up to here: to the revision of the maps, unless there were
    /// more points. What they keep beyond it is not to be told.
    Revision until = 0;
};

/// How many points after `since` the log has that `maps` does not keep, at most.
[[nodiscard]] std::size_t count_old_points(const mapping::Snapshot& maps, Revision since);

/// These points, or the first of them: until so many that together with those that are kept they are `points_max`.
/// Cost    reads the log from `since` to where all that follows is kept.
/// @param is_wanted asked now and then, as this may take seconds
/// Errors  as of ScanLog::read(); kDataLoss: an entry is damaged; kShuttingDown: it is wanted no more.
/// Thread  any that may wait for the disk.
[[nodiscard]] Result<OldPaths> read_old_paths(store::ScanLog& log, store::SessionId session,
                                              const mapping::Snapshot& maps, Revision since,
                                              const std::function<bool()>& is_wanted,
                                              std::size_t points_max = kPathPointsMax);

} // namespace scanloom::session

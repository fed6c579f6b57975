#pragma once

#include "common/error/error.hpp"
#include "server/mapping/snapshot.hpp"
#include "server/mapping/trajectory.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <vector>

/// The parts of robots' paths that are in memory no more, which is bounded: what the log tells of them.
namespace scanloom::session {

/// Points that are read at once at most: 40 MiB, and up to 60 MiB of text that is made of them.
inline constexpr std::size_t kOldPointsMax = std::size_t{1} << 20;

struct OldPaths {
    std::vector<std::vector<mapping::TrajectoryPoint>> robots; ///< by RobotIndex, each by rising revision

    /// With what the trajectories keep, the paths are whole up to here: to the revision of the maps, unless there were
    /// more points.
    Revision until = 0;
};

/// How many points after `since` the log has that `maps` does not keep, at most.
[[nodiscard]] std::size_t count_old_points(const mapping::Snapshot& maps, Revision since);

/// These points, or the first of them.
/// Cost    reads the log from `since` to where all that follows is kept.
/// Errors  as of ScanLog::read(); kStoreFailed: an entry is damaged.
/// Thread  any that may wait for the disk.
[[nodiscard]] Result<OldPaths> read_old_paths(store::ScanLog& log, store::SessionId session,
                                              const mapping::Snapshot& maps, Revision since,
                                              std::size_t points_max = kOldPointsMax);

} // namespace scanloom::session

#pragma once

#include "common/error/error.hpp"
#include "core/mapping/snapshot.hpp"
#include "core/mapping/trajectory.hpp"
#include "server/store/scan_log.hpp"

#include <cstddef>
#include <functional>
#include <vector>

/// Reads the old parts of robots' trajectories from the log. The maps keep only a bounded number of points in memory.
namespace scanloom::sessions {

/// Upper bound of the points of all robots that are returned at once. They take up to 40 MiB while they are read, and
/// 30 MiB as text.
inline constexpr std::size_t kTrajectoryPointsMax = std::size_t{1} << 19;

/// Points of trajectories that are no longer in memory.
struct StoredTrajectories {
    std::vector<std::vector<mapping::TrajectoryPoint>> robots; ///< by RobotIndex, each in ascending order of revisions

    /// Up to this revision, these points and those in the maps are complete. It is the revision of the maps, unless
    /// there were too many points. Points of the maps after it must be ignored.
    Revision until = 0;
};

/// Returns an upper bound of the points after `since` that are in the log but not in `maps`.
[[nodiscard]] std::size_t count_old_points(const mapping::Snapshot& maps, Revision since);

/// Reads the points after `since` that are not in `maps`. Stops early if they and the points in `maps` would be more
/// than `points_max`; see StoredTrajectories::until.
///
/// Cost: reads the log up to the first revision from which `maps` has all points; from its start if the filter of scans
/// depends on earlier scans (max_jump), otherwise from `since`.
/// @param is_wanted  called from time to time, because this may take seconds; false cancels
/// Errors: those of ScanLog::read(); kDataLoss if an entry is damaged; kShuttingDown if is_wanted returned false.
/// Threads: any thread that may wait for the disk.
[[nodiscard]] Result<StoredTrajectories> read_old_paths(store::ScanLog& log, store::SessionId session,
                                                        const mapping::Snapshot& maps, Revision since,
                                                        const std::function<bool()>& is_wanted,
                                                        std::size_t points_max = kTrajectoryPointsMax);

} // namespace scanloom::sessions

#include "server/sessions/stored_trajectories.hpp"

#include "common/scan/scan_filter.hpp"
#include "common/wire/log_codec.hpp"
#include "server/sessions/recovery.hpp"

#include <algorithm>

namespace scanloom::sessions {
namespace {

constexpr Revision kAskEvery = 1024; // entries, which take a few milliseconds

/// Returns the first revision from which the maps keep all points of a robot.
Revision kept_from(const mapping::Snapshot& maps, const mapping::TrajectoryView& path) {
    if (path.begin() == 0) return 0;
    return path.begin() < path.size() ? path[path.begin()].revision : maps.revision + 1;
}

/// Returns the number of a robot's old points up to `until`.
std::ptrdiff_t count_until(const std::vector<mapping::TrajectoryPoint>& points, Revision until) {
    return std::ranges::upper_bound(points, until, {}, &mapping::TrajectoryPoint::revision) - points.begin();
}

/// Returns the number of points of all robots in (since, until], in `old` and in the maps.
std::size_t count_until(const StoredTrajectories& old, const mapping::Snapshot& maps, Revision since, Revision until) {
    std::size_t points = 0;
    for (std::size_t robot = 0; robot < maps.robots.size(); ++robot) {
        const auto& kept = maps.robots[robot].trajectory;
        points += static_cast<std::size_t>(count_until(old.robots[robot], until)) + kept.first_after(until) -
                  kept.first_after(since);
    }
    return points;
}

/// Reduces old.until to the last revision up to which there are at most `points_max` points, and removes later points.
void shorten(StoredTrajectories& old, const mapping::Snapshot& maps, Revision since, std::size_t points_max) {
    if (count_until(old, maps, since, old.until) <= points_max) return;
    Revision beyond = old.until;
    old.until = since;
    while (beyond - old.until > 1) {
        const Revision middle = old.until + (beyond - old.until) / 2;
        (count_until(old, maps, since, middle) <= points_max ? old.until : beyond) = middle;
    }
    for (auto& points : old.robots) points.resize(static_cast<std::size_t>(count_until(points, old.until)));
}

} // namespace

std::size_t count_old_points(const mapping::Snapshot& maps, Revision since) {
    std::size_t points = 0;
    for (const auto& robot : maps.robots) {
        const auto kept = kept_from(maps, robot.trajectory);
        if (kept > since + 1) points += std::min<std::size_t>(robot.trajectory.begin(), kept - since - 1);
    }
    return points;
}

Result<StoredTrajectories> read_old_paths(store::ScanLog& log, store::SessionId session, const mapping::Snapshot& maps,
                                          Revision since, const std::function<bool()>& is_wanted,
                                          std::size_t points_max) {
    StoredTrajectories paths{std::vector<std::vector<mapping::TrajectoryPoint>>(maps.robots.size()), maps.revision};
    std::vector<Revision> kept;
    for (const auto& robot : maps.robots) kept.push_back(kept_from(maps, robot.trajectory));
    const Revision all_kept = kept.empty() ? 0 : *std::ranges::max_element(kept);
    std::size_t points = 0;
    ScanFilter filter(maps.config.max_jump, maps.exclusions);
    const auto visit = [&](Revision revision, std::string_view bytes) -> store::Visited {
        if (revision >= all_kept) return store::Visit::kStop; // the rest is in memory
        if (revision % kAskEvery == 0 && !is_wanted()) {
            return Error{Errc::kShuttingDown, "the server is shutting down; try again when it is back"};
        }
        if (points == points_max) {
            paths.until = revision - 1;
            return store::Visit::kStop;
        }
        auto taken = wire::decode_scan_pose(bytes);
        if (!taken) return damaged_entry(revision, taken.error());
        if (*taken) maps.scan_poses.place(**taken);
        if (!*taken || (*taken)->robot >= kept.size() || revision >= kept[(*taken)->robot]) return {};
        const ScanUse use = filter.take(revision, **taken);
        if (!is_in_trajectory(use) || revision <= since) return {};
        paths.robots[(*taken)->robot].push_back({revision, (*taken)->stamp, *(*taken)->pose});
        ++points;
        return {};
    };
    if (all_kept > since + 1) {
        const auto read = log.read(session, filter.depends_on_earlier_scans() ? 0 : since, visit);
        if (!read) return read.error();
    }
    shorten(paths, maps, since, points_max);
    return paths;
}

} // namespace scanloom::sessions

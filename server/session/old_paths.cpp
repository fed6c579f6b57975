#include "server/session/old_paths.hpp"

#include "common/wire/log_codec.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::session {
namespace {

const Error kEnough{Errc::kShuttingDown, "what follows is kept in memory, or too much"};

/// From this revision on, a robot's points are kept.
Revision kept_from(const mapping::Snapshot& maps, const mapping::TrajectoryView& path) {
    if (path.begin() == 0) return 0;
    return path.begin() < path.size() ? path[path.begin()].revision : maps.revision + 1;
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

Result<OldPaths> read_old_paths(store::ScanLog& log, store::SessionId session, const mapping::Snapshot& maps,
                                Revision since, std::size_t points_max) {
    OldPaths paths{std::vector<std::vector<mapping::TrajectoryPoint>>(maps.robots.size()), maps.revision};
    std::vector<Revision> kept;
    for (const auto& robot : maps.robots) kept.push_back(kept_from(maps, robot.trajectory));
    const Revision all_kept = kept.empty() ? 0 : *std::ranges::max_element(kept);
    if (all_kept <= since + 1) return paths;
    std::size_t points = 0;
    const auto read = log.read(session, since, [&](Revision revision, std::string_view bytes) -> Result<> {
        if (revision >= all_kept) return kEnough;
        if (points == points_max) {
            paths.until = revision - 1;
            return kEnough;
        }
        const auto taken = wire::decode_scan_pose(bytes);
        if (!taken) {
            return Error{Errc::kStoreFailed, fmt::format("log entry {}: {}", revision, taken.error().message)};
        }
        if (!*taken || (*taken)->robot >= kept.size() || revision >= kept[(*taken)->robot]) return {};
        paths.robots[(*taken)->robot].push_back({revision, (*taken)->stamp, (*taken)->pose});
        ++points;
        return {};
    });
    if (!read && read.error() != kEnough) return read.error();
    return paths;
}

} // namespace scanloom::session

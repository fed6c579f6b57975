#include "server/sessions/summary.hpp"

#include "core/mapping/projection.hpp"
#include "server/sessions/checkpoint_reader.hpp"

#include <utility>
#include <vector>

namespace scanloom::sessions {
namespace {

const Error kSummaryIsRead{Errc::kShuttingDown, "only sensors and cells follow"};

Summary summary_of(const mapping::ProjectionState& state, const std::vector<mapping::Localization>& localization,
                   const mapping::MapConfig& config) {
    mapping::Snapshot facts{.revision = state.revision,
                            .config = config,
                            .exclusions = state.exclusions,
                            .bounds = state.bounds,
                            .is_localize_only = state.is_localize_only};
    for (const auto& robot : state.robots) {
        auto& shown = facts.robots.emplace_back();
        shown.name = robot.name;
        shown.body_radius = robot.body_radius;
        shown.poses = robot.poses;
        if (facts.robots.size() <= localization.size()) shown.localization = localization[facts.robots.size() - 1];
        shown.last_seq = robot.last_seq;
        shown.scan_count = robot.scan_count;
        shown.jumps = robot.jumps.left_out;
        shown.excluded = robot.excluded;
        shown.unplaced = robot.unplaced;
        if (!robot.newest) continue;
        shown.stamp = robot.newest->stamp;
        shown.pose = robot.newest->pose;
    }
    return {std::make_shared<const mapping::Snapshot>(std::move(facts)), state.pages};
}

} // namespace

Summary summary_of(const mapping::Snapshot& snapshot) {
    mapping::Snapshot facts{.revision = snapshot.revision,
                            .config = snapshot.config,
                            .exclusions = snapshot.exclusions,
                            .bounds = snapshot.bounds,
                            .is_localize_only = snapshot.is_localize_only};
    for (const auto& robot : snapshot.robots) {
        auto& shown = facts.robots.emplace_back(robot);
        shown.trajectory = {};
        shown.newest_scan = nullptr;
        shown.newest_scans.clear();
    }
    return {std::make_shared<const mapping::Snapshot>(std::move(facts)), snapshot.chunk_count};
}

Result<std::optional<Summary>> read_summary(store::ScanLog& log, store::SessionId session,
                                            const mapping::MapConfig& config) {
    const auto end = log.end_of(session);
    if (!end) return end.error();
    auto summary = read_checkpointed_summary(log, session, config);
    if (summary && *summary && (*summary)->facts->revision != *end) return std::optional<Summary>{};
    return summary;
}

Result<std::optional<Summary>> read_checkpointed_summary(store::ScanLog& log, store::SessionId session,
                                                         const mapping::MapConfig& config) {
    CheckpointReader reader(config);
    std::optional<Error> unusable;
    auto read = log.read_checkpoint(session, [&](std::string_view key, std::string_view value) -> Result<> {
        if (key >= CheckpointReader::kAfterState) return kSummaryIsRead;
        auto added = reader.add(key, value);
        if (!added) unusable = added.error();
        return added;
    });
    if (unusable) return std::optional<Summary>{};
    if (!read && read.error() != kSummaryIsRead) return read.error();
    const auto localization = reader.localization();
    const auto state = std::move(reader).state();
    if (!state) return std::optional<Summary>{};
    return std::optional(summary_of(*state, localization, config));
}

} // namespace scanloom::sessions

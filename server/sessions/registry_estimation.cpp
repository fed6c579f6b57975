#include "server/log/context.hpp"
#include "server/sessions/odometry_copy.hpp"
#include "server/sessions/session_registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <new>
#include <utility>

/// The part of SessionRegistry that has the poses of recorded sessions estimated.
namespace scanloom::sessions {
namespace {

bool sends_map_poses(const mapping::RobotState& robot) { return robot.poses == Poses::kMap; }

/// Returns an error if a robot is connected that would have to state other poses.
Result<> check_disconnected(const Session& session) {
    const auto& robots = session.snapshot()->robots;
    for (RobotIndex robot = 0; robot < robots.size(); ++robot) {
        if (!sends_map_poses(robots[robot]) || !session.is_connected(robot)) continue;
        return Error{Errc::kConflict,
                     fmt::format("robot '{}' is connected and sends poses in the map frame; stop it, and "
                                 "start it with --poses odometry when the poses are estimated",
                                 robots[robot].name)};
    }
    return {};
}

/// Returns the summary of a session without map poses until it is loaded.
Summary estimated(Summary summary) {
    auto facts = std::make_shared<mapping::Snapshot>(*summary.facts);
    for (auto& robot : facts->robots) {
        if (sends_map_poses(robot)) robot.poses = Poses::kOdometry;
    }
    summary.facts = std::move(facts);
    return summary;
}

} // namespace

Result<SessionInfo> SessionRegistry::estimate(std::string_view name) {
    std::unique_lock changing(changing_);
    if (state_.draining) return shutting_down();
    const auto used = load_shared(name);
    if (!used) return used.error();
    auto left = state_.cache.begin_change(name);
    changing.unlock(); // a long log takes minutes; drain() waits for the end of the transition
    if (!left) return state_.why_missing(name);
    const auto before = [&]() -> Result<SessionInfo> {
        try {
            SessionInfo info = left->info;
            const auto taken = take_as_odometry(*left);
            return taken ? Result<SessionInfo>(std::move(info)) : taken.error();
        } catch (const std::bad_alloc&) {
            return Error{Errc::kOverloaded, "there is no memory left for this; try again later"};
        }
    }();
    const bool is_open = left->session && !left->session->closing();
    loader_.load(is_open ? state_.cache.cancel_change(name)
                         : state_.cache.end_replacement(left->info, std::move(left->summary)));
    if (!before) return before.error();
    load(name, [](const Result<std::shared_ptr<Session>>&) {});
    log::info({.session = name}, "session '{}': the poses of its robots are estimated", name);
    return before;
}

/// Closes a session and replaces it by its copy with odometry, if it has poses in the map frame. Otherwise removes its
/// checkpoint, so that its poses are estimated again.
/// @param left  its id and its summary become those of the copy
Result<> SessionRegistry::take_as_odometry(ListedSession& left) {
    if (left.session) {
        if (auto ready = check_disconnected(*left.session); !ready) return ready;
        left.summary = summary_of(*left.session->snapshot());
        discard_and_wait(*left.session, maps_are_computed_again(left.info.name));
        left.summary = summary_of(*left.session->snapshot()); // a robot may have joined since
    }
    if (std::ranges::none_of(left.summary.facts->robots, sends_map_poses)) {
        return state_.log.clear_checkpoint(left.info.id);
    }
    Summary summary = estimated(left.summary);
    const auto copy = copy_as_odometry(state_.log, left.info.id, state_.draining);
    if (!copy) return copy.error();
    if (auto removed = state_.log.remove_session(left.info.id); !removed) return removed;
    left.info.id = *copy;
    left.summary = std::move(summary);
    return {};
}

} // namespace scanloom::sessions

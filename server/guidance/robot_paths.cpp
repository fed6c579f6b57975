#include "server/guidance/robot_paths.hpp"

#include <algorithm>
#include <utility>

namespace scanloom::guidance {

std::uint64_t RobotPaths::give_goal(const SessionPtr& session, RobotIndex robot, const Goal& goal, HeldPath path,
                                    Clock::time_point now) {
    const bool connected = session->is_connected(robot);
    std::uint64_t given = 0;
    {
        const std::lock_guard lock(mutex_);
        Record& record = record_of(session);
        record.holdings.erase(robot);
        record.explored.erase(robot);
        given = ++record.revision;
        record.holdings[robot] = {now, connected, goal, given, bounded(record, std::move(path))};
    }
    session->notify_changed();
    return given;
}

void RobotPaths::set_path(const SessionPtr& session, RobotIndex robot, std::optional<HeldPath> path,
                          Clock::time_point now) {
    {
        const std::lock_guard lock(mutex_);
        Record& record = record_of(session);
        auto& holding = record.holdings.try_emplace(robot, Holding{now, true, {}, 0, {}}).first->second;
        const bool had_none = !holding.path;
        holding.was_connected = true; // otherwise it could not have asked
        holding.path = nullptr;
        if (path) holding.path = bounded(record, std::move(*path));
        const bool has_none = !holding.path;
        if (has_none && !holding.goal) record.holdings.erase(robot);
        if (had_none && has_none) return;
        ++record.revision;
    }
    session->notify_changed();
}

void RobotPaths::take_back(const SessionPtr& session, RobotIndex robot, bool explored) {
    {
        const std::lock_guard lock(mutex_);
        if (!explored && !records_.contains(session)) return;
        Record& record = record_of(session);
        const bool held = record.holdings.erase(robot) > 0;
        const bool is_news = explored ? record.explored.insert(robot).second : record.explored.erase(robot) > 0;
        if (!held && !is_news) return;
        ++record.revision;
    }
    session->notify_changed();
}

bool RobotPaths::holds(const SessionPtr& session, RobotIndex robot, std::uint64_t goal, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const Record* record = find(session, now);
    if (record == nullptr) return false;
    const auto held = record->holdings.find(robot);
    return held != record->holdings.end() && held->second.goal && held->second.goal_given == goal;
}

RobotPaths::State RobotPaths::state(const SessionPtr& session, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const Record* record = find(session, now);
    if (record == nullptr) return {};
    State state{record->revision};
    for (const auto& [robot, holding] : record->holdings) {
        if (holding.was_connected) continue; // its session notifies when it leaves
        state.until = std::min(state.until, holding.given + kKeptForAbsent + Clock::duration(1));
    }
    return state;
}

RobotPaths::Page RobotPaths::page(const SessionPtr& session, Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const Record* record = find(session, now);
    if (record == nullptr) return {};
    Page page{record->revision, {}, {record->explored.begin(), record->explored.end()}};
    for (const auto& [robot, holding] : record->holdings) page.robots.push_back({robot, holding.goal, holding.path});
    return page;
}

RobotPaths::Record& RobotPaths::record_of(const SessionPtr& session) {
    std::erase_if(records_, [](const auto& one) { return one.first.expired(); });
    return records_[session];
}

/// Returns what the session's robots hold now, or nullptr if nothing was given yet.
RobotPaths::Record* RobotPaths::find(const SessionPtr& session, Clock::time_point now) {
    const auto found = records_.find(session);
    if (found == records_.end()) return nullptr;
    remove_expired(found->second, *session, now);
    return &found->second;
}

/// Returns the path, cut to as many points as the record has room for, at least the first two.
std::shared_ptr<const HeldPath> RobotPaths::bounded(const Record& record, HeldPath path) {
    std::size_t room = kSessionPathPointsMax;
    for (const auto& [robot, holding] : record.holdings) {
        if (holding.path) room -= std::min(room, holding.path->points.size());
    }
    const std::size_t kept = std::min(path.points.size(), std::clamp<std::size_t>(room, 2, kShownPathPointsMax));
    path.points_left_out += path.points.size() - kept;
    path.points.resize(kept);
    path.points.shrink_to_fit();
    return std::make_shared<const HeldPath>(std::move(path));
}

void RobotPaths::remove_expired(Record& record, const sessions::Session& session, Clock::time_point now) {
    if (record.holdings.empty()) return;
    const auto connected = session.connected();
    const auto is_here = [&](RobotIndex robot) { return robot < connected.size() && connected[robot]; };
    for (auto& [robot, holding] : record.holdings) holding.was_connected = holding.was_connected || is_here(robot);
    const auto forgotten = std::erase_if(record.holdings, [&](const auto& one) {
        const auto& [robot, holding] = one;
        return !is_here(robot) && (holding.was_connected || now - holding.given > kKeptForAbsent);
    });
    if (forgotten > 0) ++record.revision;
}

} // namespace scanloom::guidance

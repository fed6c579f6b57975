#include "server/guide/goal_book.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace scanloom::guide {
namespace {

grid::Cell cell_of(const Point2& point, double cell_size) {
    const double per_metre = 1.0 / cell_size;
    return {static_cast<std::int32_t>(std::floor(point.x * per_metre)),
            static_cast<std::int32_t>(std::floor(point.y * per_metre))};
}

Point2 centre_of(grid::Cell cell, double cell_size) { return {(cell.i + 0.5) * cell_size, (cell.j + 0.5) * cell_size}; }

/// Returns the state of a robot in the maps, or an empty one if the robot joined after their last entry.
mapping::RobotState state_of(const mapping::Snapshot& maps, RobotIndex robot) {
    return robot < maps.robots.size() ? maps.robots[robot] : mapping::RobotState{};
}

/// Appends the cells that `to` does not contain yet, then removes the oldest ones beyond kInVainCellsMax.
void add(const std::vector<grid::Cell>& cells, std::vector<grid::Cell>& to) {
    const auto place = [](grid::Cell cell) { return std::pair(cell.j, cell.i); };
    auto known = to;
    std::ranges::sort(known, {}, place);
    std::ranges::copy_if(cells, std::back_inserter(to),
                         [&](grid::Cell cell) { return !std::ranges::binary_search(known, place(cell), {}, place); });
    const std::size_t too_many = std::max(to.size(), GoalBook::kInVainCellsMax) - GoalBook::kInVainCellsMax;
    to.erase(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(too_many));
}

Visit begin_visit(const planning::FrontierGoal& goal, const mapping::RobotState& state, double cell_size,
                  double body_radius) {
    return {centre_of(goal.cell, cell_size), centre_of(goal.target, cell_size), arrival_radius(body_radius, cell_size),
            state.scan_count, std::nullopt};
}

Goal told(const planning::FrontierGoal& goal, const mapping::Snapshot& maps) {
    const double cell_size = maps.config.cell_size;
    return {centre_of(goal.cell, cell_size), centre_of(goal.target, cell_size), goal.in_danger, maps.revision};
}

} // namespace

Result<planning::NextGoal> GoalBook::next(const std::shared_ptr<const session::Session>& session,
                                          const mapping::Snapshot& maps, RobotIndex robot, const Point2& position,
                                          Clock::time_point now, const planning::ExplorationOptions& options) {
    const double cell_size = maps.config.cell_size;
    const std::lock_guard lock(mutex_);
    forget_what_counts_no_longer(now);
    const mapping::RobotState state = state_of(maps, robot);
    InVain in_vain = take_in_vain(session, maps);
    std::optional<Visit> going_on; // the robot is at the goal but has not looked yet
    if (const auto* had = find_entry(session, robot);
        had != nullptr && had->settings == maps.config && is_there(had->visit, state)) {
        if (has_looked(had->visit, state, cell_size)) {
            add(planning::seen_in_vain(maps.classes, had->goal, had->around_target), in_vain.cells);
            count_look(had->around_target, in_vain);
        } else {
            going_on = had->visit;
        }
    }
    add(planning::still_frontier(maps.classes, looked_at_often(in_vain)), in_vain.cells);
    auto found = planning::next_goal(maps.classes, cell_size, position, targets_of_others(session, robot, cell_size),
                                     options, in_vain.cells);
    keep(std::move(in_vain));
    forget_entry(session, robot);
    if (!found || !found->goal) {
        ways_.take_back(session, robot, found && found->outcome == planning::Exploration::kComplete);
        return found;
    }
    Visit visit = begin_visit(*found->goal, state, cell_size, options.passability.body_radius_m);
    if (going_on && is_there(visit, state)) { // also for a better goal: the robot keeps its waiting time
        visit.asking_since = going_on->asking_since.value_or(state.stamp);
    }
    const auto given = ways_.give_goal(session, robot, told(*found->goal, maps),
                                       {WayKind::kGoal, found->path.points, found->path.length_m, maps.revision}, now);
    entries_.push_back({session, robot, given, maps.config, found->goal->cell, found->around_target, visit});
    return found;
}

const GoalBook::Entry* GoalBook::find_entry(const std::shared_ptr<const session::Session>& session,
                                            RobotIndex robot) const {
    const auto entry = std::ranges::find_if(
        entries_, [&](const Entry& one) { return one.robot == robot && one.session.lock() == session; });
    return entry == entries_.end() ? nullptr : &*entry;
}

void GoalBook::forget_entry(const std::shared_ptr<const session::Session>& session, RobotIndex robot) {
    std::erase_if(entries_, [&](const Entry& one) { return one.robot == robot && one.session.lock() == session; });
}

std::vector<grid::Cell> GoalBook::targets_of_others(const std::shared_ptr<const session::Session>& session,
                                                    RobotIndex robot, double cell_size) const {
    std::vector<grid::Cell> targets;
    for (const Entry& entry : entries_) {
        if (entry.robot != robot && entry.session.lock() == session)
            targets.push_back(cell_of(entry.visit.target, cell_size));
    }
    return targets;
}

/// Removes and returns the record of the session and settings, without cells that are no longer FRONTIER. Maps older
/// than the record do not change it.
GoalBook::InVain GoalBook::take_in_vain(const std::shared_ptr<const session::Session>& session,
                                        const mapping::Snapshot& maps) {
    const auto known = std::ranges::find_if(
        in_vain_, [&](const InVain& one) { return one.settings == maps.config && one.session.lock() == session; });
    if (known == in_vain_.end()) return {session, maps.config, maps.revision, {}, {}};
    InVain taken = std::move(*known);
    in_vain_.erase(known);
    if (maps.revision < taken.revision) return taken;
    taken.revision = maps.revision;
    taken.cells = planning::still_frontier(maps.classes, taken.cells);
    return taken;
}

void GoalBook::keep(InVain in_vain) {
    if (in_vain.cells.empty() && in_vain.looks.empty()) return;
    const auto session = in_vain.session.lock();
    const auto is_of_session = [&](const InVain& one) { return one.session.lock() == session; };
    if (std::ranges::count_if(in_vain_, is_of_session) == static_cast<std::ptrdiff_t>(kSettingsMax)) {
        in_vain_.erase(std::ranges::find_if(in_vain_, is_of_session));
    }
    in_vain_.push_back(std::move(in_vain));
}

void GoalBook::count_look(const std::vector<grid::Cell>& around_target, InVain& in_vain) {
    if (in_vain.looks.size() + around_target.size() > kInVainCellsMax) in_vain.looks.clear();
    for (const grid::Cell cell : around_target) ++in_vain.looks[{cell.j, cell.i}];
}

std::vector<grid::Cell> GoalBook::looked_at_often(const InVain& in_vain) {
    std::vector<grid::Cell> cells;
    for (const auto& [place, times] : in_vain.looks) {
        if (times >= kLooksMax) cells.push_back({place.second, place.first});
    }
    return cells;
}

void GoalBook::forget_what_counts_no_longer(Clock::time_point now) {
    std::erase_if(in_vain_, [](const InVain& one) { return one.session.expired(); });
    std::erase_if(entries_, [&](const Entry& entry) {
        const auto session = entry.session.lock();
        return !session || !ways_.holds(session, entry.robot, entry.given, now);
    });
}

} // namespace scanloom::guide

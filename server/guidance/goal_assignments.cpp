#include "server/guidance/goal_assignments.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace scanloom::guidance {
namespace {

bool is_within(const Pose2& pose, const Point2& place, double radius) {
    return std::hypot(pose.x - place.x, pose.y - place.y) <= radius;
}

bool heads(const Pose2& pose, const Point2& from, const Point2& to) {
    const double direction = std::atan2(to.y - from.y, to.x - from.x);
    return std::abs(normalize_angle(pose.yaw - direction)) <= kLookingWithin;
}

bool faces_target(const Visit& visit, const Pose2& pose, double cell_size_m) {
    return is_within(pose, visit.target, kOnTargetCells * cell_size_m) || heads(pose, visit.goal, visit.target) ||
           heads(pose, {pose.x, pose.y}, visit.target);
}

/// Returns whether the robot stood at the goal for kLookingTakes, going back through its scans as long as they were
/// taken there.
bool has_stood(const Visit& visit, const mapping::RobotState& robot) {
    if (!visit.asking_since) return false;
    for (std::size_t n = robot.trajectory.size(); n > robot.trajectory.begin(); --n) {
        const auto& point = robot.trajectory[n - 1];
        if (point.stamp < *visit.asking_since || !is_within(point.pose, visit.goal, visit.arrival_radius)) return false;
        if (robot.stamp - point.stamp >= kLookingTakes) return true;
    }
    return false;
}

} // namespace

double arrival_radius(double body_radius_m, double cell_size_m) {
    return std::max(body_radius_m, kArrivedCells * cell_size_m);
}

bool is_there(const Visit& visit, const mapping::RobotState& robot) {
    return robot.pose && is_within(*robot.pose, visit.goal, visit.arrival_radius);
}

bool has_looked(const Visit& visit, const mapping::RobotState& robot, double cell_size_m) {
    if (!is_there(visit, robot) || robot.scan_count <= visit.scans_before) return false;
    return faces_target(visit, *robot.pose, cell_size_m) || has_stood(visit, robot);
}

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

/// Appends the cells that `to` does not contain yet, then removes the oldest ones beyond kUnobservedCellsMax.
void add(const std::vector<grid::Cell>& cells, std::vector<grid::Cell>& to) {
    const auto place = [](grid::Cell cell) { return std::pair(cell.j, cell.i); };
    auto known = to;
    std::ranges::sort(known, {}, place);
    std::ranges::copy_if(cells, std::back_inserter(to),
                         [&](grid::Cell cell) { return !std::ranges::binary_search(known, place(cell), {}, place); });
    const std::size_t too_many =
        std::max(to.size(), GoalAssignments::kUnobservedCellsMax) - GoalAssignments::kUnobservedCellsMax;
    to.erase(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(too_many));
}

Visit begin_visit(const planning::FrontierGoal& goal, const mapping::RobotState& state, double cell_size,
                  double body_radius) {
    return {centre_of(goal.cell, cell_size), centre_of(goal.target, cell_size), arrival_radius(body_radius, cell_size),
            state.scan_count, std::nullopt};
}

Goal shared_goal(const planning::FrontierGoal& goal, const mapping::Snapshot& maps) {
    const double cell_size = maps.config.cell_size;
    return {centre_of(goal.cell, cell_size), centre_of(goal.target, cell_size), goal.in_danger, maps.revision};
}

} // namespace

Result<planning::NextGoal> GoalAssignments::next(const std::shared_ptr<const sessions::Session>& session,
                                                 const mapping::Snapshot& maps, RobotIndex robot,
                                                 const Point2& position, Clock::time_point now,
                                                 const planning::ExplorationOptions& options) {
    const double cell_size = maps.config.cell_size;
    const std::lock_guard lock(mutex_);
    remove_expired(now);
    const mapping::RobotState state = state_of(maps, robot);
    Unobserved unobserved = take_unobserved(session, maps);
    std::optional<Visit> going_on; // the robot is at the goal but has not looked yet
    if (const auto* had = find_entry(session, robot);
        had != nullptr && had->settings == maps.config && is_there(had->visit, state)) {
        if (has_looked(had->visit, state, cell_size)) {
            add(planning::unobservable_cells(maps.classes, had->goal, had->around_target), unobserved.cells);
            count_look(had->around_target, unobserved);
        } else {
            going_on = had->visit;
        }
    }
    add(planning::still_frontier(maps.classes, looked_at_often(unobserved)), unobserved.cells);
    auto found = planning::next_goal(maps.classes, cell_size, position, targets_of_others(session, robot, cell_size),
                                     options, unobserved.cells);
    keep(std::move(unobserved));
    forget_entry(session, robot);
    if (!found || !found->goal) {
        paths_.take_back(session, robot, found && found->outcome == planning::Exploration::kComplete);
        return found;
    }
    Visit visit = begin_visit(*found->goal, state, cell_size, options.passability.body_radius_m);
    if (going_on && is_there(visit, state)) { // also for a better goal: the robot keeps its waiting time
        visit.asking_since = going_on->asking_since.value_or(state.stamp);
    }
    const auto given =
        paths_.give_goal(session, robot, shared_goal(*found->goal, maps),
                         {PathKind::kGoal, found->path.points, found->path.length_m, maps.revision}, now);
    entries_.push_back({session, robot, given, maps.config, found->goal->cell, found->around_target, visit});
    return found;
}

const GoalAssignments::Entry* GoalAssignments::find_entry(const std::shared_ptr<const sessions::Session>& session,
                                                          RobotIndex robot) const {
    const auto entry = std::ranges::find_if(
        entries_, [&](const Entry& one) { return one.robot == robot && one.session.lock() == session; });
    return entry == entries_.end() ? nullptr : &*entry;
}

void GoalAssignments::forget_entry(const std::shared_ptr<const sessions::Session>& session, RobotIndex robot) {
    std::erase_if(entries_, [&](const Entry& one) { return one.robot == robot && one.session.lock() == session; });
}

std::vector<grid::Cell> GoalAssignments::targets_of_others(const std::shared_ptr<const sessions::Session>& session,
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
GoalAssignments::Unobserved GoalAssignments::take_unobserved(const std::shared_ptr<const sessions::Session>& session,
                                                             const mapping::Snapshot& maps) {
    const auto known = std::ranges::find_if(unobserved_, [&](const Unobserved& one) {
        return one.settings == maps.config && one.session.lock() == session;
    });
    if (known == unobserved_.end()) return {session, maps.config, maps.revision, {}, {}};
    Unobserved taken = std::move(*known);
    unobserved_.erase(known);
    if (maps.revision < taken.revision) return taken;
    taken.revision = maps.revision;
    taken.cells = planning::still_frontier(maps.classes, taken.cells);
    return taken;
}

void GoalAssignments::keep(Unobserved unobserved) {
    if (unobserved.cells.empty() && unobserved.looks.empty()) return;
    const auto session = unobserved.session.lock();
    const auto is_of_session = [&](const Unobserved& one) { return one.session.lock() == session; };
    if (std::ranges::count_if(unobserved_, is_of_session) == static_cast<std::ptrdiff_t>(kSettingsMax)) {
        unobserved_.erase(std::ranges::find_if(unobserved_, is_of_session));
    }
    unobserved_.push_back(std::move(unobserved));
}

void GoalAssignments::count_look(const std::vector<grid::Cell>& around_target, Unobserved& unobserved) {
    if (unobserved.looks.size() + around_target.size() > kUnobservedCellsMax) unobserved.looks.clear();
    for (const grid::Cell cell : around_target) ++unobserved.looks[{cell.j, cell.i}];
}

std::vector<grid::Cell> GoalAssignments::looked_at_often(const Unobserved& unobserved) {
    std::vector<grid::Cell> cells;
    for (const auto& [place, times] : unobserved.looks) {
        if (times >= kLooksMax) cells.push_back({place.second, place.first});
    }
    return cells;
}

void GoalAssignments::remove_expired(Clock::time_point now) {
    std::erase_if(unobserved_, [](const Unobserved& one) { return one.session.expired(); });
    std::erase_if(entries_, [&](const Entry& entry) {
        const auto session = entry.session.lock();
        return !session || !paths_.holds(session, entry.robot, entry.given, now);
    });
}

} // namespace scanloom::guidance

#include "server/guide/goal_book.hpp"

#include <cmath>

namespace scanloom::guide {
namespace {

grid::Cell cell_of(const Point2& point, double cell_size) {
    const double per_metre = 1.0 / cell_size;
    return {static_cast<std::int32_t>(std::floor(point.x() * per_metre)),
            static_cast<std::int32_t>(std::floor(point.y() * per_metre))};
}

Point2 centre_of(grid::Cell cell, double cell_size) { return {(cell.i + 0.5) * cell_size, (cell.j + 0.5) * cell_size}; }

} // namespace

Result<planning::NextGoal> GoalBook::next(const std::shared_ptr<const session::Session>& session,
                                          const mapping::Snapshot& maps, RobotIndex robot, const Point2& position,
                                          Clock::time_point now, const planning::ExplorationOptions& options) {
    const double cell_size = maps.config.cell_size;
    const std::lock_guard lock(mutex_);
    forget_what_counts_no_longer(now);
    std::vector<grid::Cell> of_others;
    std::erase_if(entries_, [&](const Entry& entry) {
        if (entry.session.lock() != session) return false;
        if (entry.robot != robot) of_others.push_back(cell_of(entry.target, cell_size));
        return entry.robot == robot;
    });
    auto found = planning::next_goal(maps.classes, cell_size, position, of_others, options);
    if (found && found->goal) {
        const Point2 target = centre_of(found->goal->target, cell_size);
        entries_.push_back({session, robot, target, now, session->is_connected(robot)});
    }
    return found;
}

void GoalBook::forget_what_counts_no_longer(Clock::time_point now) {
    std::erase_if(entries_, [&](Entry& entry) {
        const auto session = entry.session.lock();
        if (!session) return true;
        if (session->is_connected(entry.robot)) {
            entry.was_connected = true;
            return false;
        }
        return entry.was_connected || now - entry.given > kKeptForAbsent;
    });
}

} // namespace scanloom::guide

#include "sim/drive/explore.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/drive/nearby_obstacles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace scanloom::sim {
namespace {

constexpr int kLookBlockedStepsMax = 40; // two seconds
constexpr double kElsewhere = 0.5;       // metres: farther than this from a blockage is another place
constexpr int kBlockedBeforeFree = 3;    // times, before the robot moves away from there
constexpr double kGetFree = 0.4;         // metres
constexpr int kLookDirections = 16;

/// Returns the end of the longest free straight line, up to kGetFree; among equal ones the one with the smallest turn.
Point2 free_place(const Senses& senses) {
    double best_yaw = senses.pose.yaw;
    double most = 0.0;
    for (int n = 0; n < kLookDirections; ++n) {
        const int turn = n % 2 == 0 ? n / 2 : -(n + 1) / 2; // 0, -1, 1, -2, 2, ...
        const double yaw = senses.pose.yaw + turn * 2.0 * std::numbers::pi / kLookDirections;
        const double free = std::min(kGetFree, free_ahead(senses, yaw));
        if (free <= most) continue;
        most = free;
        best_yaw = yaw;
    }
    return position_of(senses.pose) + most * Point2{std::cos(best_yaw), std::sin(best_yaw)};
}

std::string as_text(double seconds) {
    return seconds < 120.0 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.0f} min", seconds / 60.0);
}

} // namespace

Velocity Explore::step(const Senses& senses) {
    const Point2 position = position_of(senses.pose);
    note(position);
    switch (task_) {
    case Task::kLookAround: {
        const Velocity velocity = turn_.step(senses.pose);
        if (turn_.is_done()) task_ = Task::kNeedGoal;
        return velocity;
    }
    case Task::kGo:
    case Task::kGetFree: return go_on(senses);
    case Task::kLook: {
        const double yaw = direction(position, target_);
        if (!is_heading(senses.pose, yaw)) return turn_to(senses.pose, yaw);
        task_ = Task::kNeedGoal;
        break;
    }
    case Task::kWait:
        if (--steps_left_ <= 0) task_ = Task::kNeedGoal;
        break;
    case Task::kNeedGoal:
    case Task::kDone: break;
    }
    return {};
}

std::string Explore::remarks() const {
    const double seconds = static_cast<double>(steps_) * kControlPeriod;
    const std::string drive = fmt::format("{:.0f} m driven in {}", driven_, as_text(seconds));
    return is_done()
               ? fmt::format("explored: no frontier is reachable with a clearance of {} m, {}", kPathClearance, drive)
               : fmt::format("exploring: {}", drive);
}

void Explore::go(std::vector<Point2> path, const Point2& target) {
    follower_ = PathFollower(std::move(path));
    target_ = target;
    task_ = Task::kGo;
}

void Explore::look_around() {
    if (is_done()) return;
    turn_ = FullTurn();
    task_ = Task::kLookAround;
}

void Explore::wait(double seconds) {
    steps_left_ = static_cast<int>(std::lround(seconds / kControlPeriod));
    task_ = Task::kWait;
}

Velocity Explore::go_on(const Senses& senses) {
    const Velocity velocity = follower_.step(senses);
    if (follower_.has_arrived()) {
        task_ = task_ == Task::kGo ? Task::kLook : Task::kNeedGoal;
        return {};
    }
    if (follower_.blocked_steps() < kLookBlockedStepsMax) return velocity;
    if (task_ == Task::kGo) {
        request_another_path(senses);
    } else {
        task_ = Task::kNeedGoal;
    }
    return {};
}

void Explore::request_another_path(const Senses& senses) {
    const Point2 position = position_of(senses.pose);
    if (times_blocked_ > 0 && norm(position - blocked_at_) > kElsewhere) times_blocked_ = 0;
    if (times_blocked_ == 0) blocked_at_ = position;
    times_blocked_ += 1;
    task_ = Task::kNeedGoal;
    if (times_blocked_ % kBlockedBeforeFree != 0) return;
    follower_ = PathFollower({position, free_place(senses)});
    task_ = Task::kGetFree;
}

void Explore::note(const Point2& position) {
    if (has_begun_) driven_ += norm(position - last_);
    has_begun_ = true;
    last_ = position;
    steps_ += 1;
}

} // namespace scanloom::sim

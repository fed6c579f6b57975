#include "sim/drive/path_follower.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/drive/nearby_obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace scanloom::sim {
namespace {

constexpr double kGain = 4.0;      // radians per second for each radian
constexpr double kHeading = 0.03;  // radians: close enough
constexpr double kOnTheSpot = 0.4; // radians: for larger differences the robot turns before it drives
constexpr double kSpeedMin = 0.05; // metres per second, so that it arrives
constexpr double kLookingTurn = std::numbers::pi / 2.0; // radians per second, of a full turn

double turn_for(double aside) { return std::clamp(kGain * aside, -kEasyTurn, kEasyTurn); }

} // namespace

double direction(const Point2& from, const Point2& to) { return std::atan2(to.y - from.y, to.x - from.x); }

Velocity turn_to(const Pose2& pose, double yaw) { return {0.0, turn_for(normalize_angle(yaw - pose.yaw))}; }

bool is_heading(const Pose2& pose, double yaw) { return std::abs(normalize_angle(yaw - pose.yaw)) < kHeading; }

Velocity drive_towards(const Senses& senses, double yaw, double speed) {
    const double aside = normalize_angle(yaw - senses.pose.yaw);
    const double turn = turn_for(aside);
    if (std::abs(aside) >= kOnTheSpot) return {0.0, turn};
    const double forward = std::min(speed, safe_speed(senses, senses.pose.yaw)) * (1.0 - std::abs(aside) / kOnTheSpot);
    return {forward, turn};
}

double braking_speed(double metres) {
    return std::max(kSpeedMin, std::sqrt(2.0 * kEasyBraking * std::max(0.0, metres)));
}

Velocity FullTurn::step(const Pose2& pose) {
    if (has_begun_) turned_ += normalize_angle(pose.yaw - last_yaw_);
    has_begun_ = true;
    last_yaw_ = pose.yaw;
    if (is_done()) return {};
    const double left = (2.0 * std::numbers::pi - turned_) / kControlPeriod;
    return {0.0, std::min(kLookingTurn, left)};
}

bool FullTurn::is_done() const noexcept { return turned_ >= 2.0 * std::numbers::pi - 1e-6; }

namespace {

// metres
constexpr double kAhead = 0.3;
constexpr double kAtCorner = 0.03;
constexpr double kNearEnd = 0.10;
constexpr double kStopBefore = 0.2; // an obstacle on the path, in addition to kKeptClear
constexpr double kSlack = 0.08;     // how far a wall behind a corner may seem to stand in front of it
constexpr double kShort = 0.01;
// radians
constexpr double kGentleCorner = 0.3;

Point2 along(const Point2& from, const Point2& to) {
    const double length = norm(to - from);
    return length > 0.0 ? (to - from) / length : Point2{};
}

} // namespace

PathFollower::PathFollower(std::vector<Point2> path) : path_(std::move(path)) {}

Velocity PathFollower::step(const Senses& senses) {
    const Point2 position = position_of(senses.pose);
    pass_corners(position);
    if (has_arrived()) return {};
    const double to_corner = norm(path_[passed_ + 1] - position);
    const double yaw = direction(position, aim(position));
    const double free = free_ahead(senses, senses.pose.yaw);
    const bool blocks = free < to_corner - kSlack;
    double speed = kForwardMax;
    if (stops_at_next_corner()) speed = std::min(speed, braking_speed(to_corner));
    if (blocks) speed = std::min(speed, braking_speed(free - kStopBefore));
    const Velocity velocity = drive_towards(senses, yaw, speed);
    const bool is_turning = std::abs(normalize_angle(yaw - senses.pose.yaw)) > kGentleCorner;
    if (is_turning || free > (blocks ? kStopBefore : kShort)) {
        blocked_steps_ = 0;
        return velocity;
    }
    if (passed_ + 2 == path_.size() && to_corner < kNearEnd) passed_ += 1;
    blocked_steps_ += 1;
    return {0.0, velocity.turn};
}

double PathFollower::left(const Point2& position) const {
    if (has_arrived()) return 0.0;
    double metres = norm(path_[passed_ + 1] - position);
    for (std::size_t n = passed_ + 1; n + 1 < path_.size(); ++n) metres += norm(path_[n + 1] - path_[n]);
    return metres;
}

/// A corner is passed when the robot is at it, or near it and beyond.
void PathFollower::pass_corners(const Point2& position) {
    while (!has_arrived()) {
        const Point2& end = path_[passed_ + 1];
        const Point2 left = end - position;
        const bool is_beyond = norm(left) < kNearEnd && dot(left, along(path_[passed_], end)) <= 0.0;
        if (norm(left) > kAtCorner && !is_beyond) return;
        passed_ += 1;
    }
}

Point2 PathFollower::aim(const Point2& position) const {
    const Point2& begin = path_[passed_];
    const Point2& end = path_[passed_ + 1];
    const Point2 ahead = along(begin, end);
    const double length = norm(end - begin);
    const double foot = dot(position - begin, ahead);
    return begin + std::clamp(foot + kAhead, 0.0, length) * ahead;
}

bool PathFollower::stops_at_next_corner() const {
    if (passed_ + 2 >= path_.size()) return true;
    const Point2 before = along(path_[passed_], path_[passed_ + 1]);
    const Point2 after = along(path_[passed_ + 1], path_[passed_ + 2]);
    return dot(before, after) < std::cos(kGentleCorner);
}

} // namespace scanloom::sim

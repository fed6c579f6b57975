#include "sim/drive/waypoints.hpp"

#include "sim/drive/behaviour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace scanloom::sim {
namespace {

constexpr double kReach = 0.5;        // rho_0, metres
constexpr double kRepulsion = 0.002;  // eta
constexpr double kAttraction = 1.0;   // k, for each metre
constexpr double kDistanceMin = 0.02; // metres from the rim; smaller distances count as this
constexpr std::size_t kFieldDirections = 24;

std::size_t direction_of(const Point2& offset) {
    const double turn = std::atan2(offset.y, offset.x) / (2.0 * std::numbers::pi) + 0.5; // 0 .. 1
    return std::min(static_cast<std::size_t>(turn * kFieldDirections), kFieldDirections - 1);
}

Point2 repulsion(const Point2& offset) {
    const double rho = std::max(norm(offset) - kBodyRadius, kDistanceMin);
    if (rho >= kReach) return {0.0, 0.0};
    return -kRepulsion * (1.0 / rho - 1.0 / kReach) / (rho * rho) * normalized(offset);
}

} // namespace

Point2 potential_force(const Point2& position, const Point2& goal, std::span<const Point2> obstacles) {
    std::array<Point2, kFieldDirections> nearest;
    nearest.fill({kReach + kBodyRadius, 0.0}); // too far to count
    for (const Point2& obstacle : obstacles) {
        const Point2 offset = obstacle - position;
        Point2& known = nearest[direction_of(offset)];
        if (norm(offset) < norm(known)) known = offset;
    }
    Point2 force = kAttraction * (goal - position);
    if (norm(force) > 1.0) force = normalized(force);
    for (const Point2& offset : nearest) force += repulsion(offset);
    return force;
}

namespace {

constexpr double kArrived = 0.10;  // metres
constexpr double kProgress = 0.10; // metres nearer that count as progress
constexpr int kStuckSteps = 300;   // 15 seconds
constexpr std::size_t kAbandonedShown = 5;
constexpr double kForceMin = 1e-9; // a shorter force has no direction

/// Returns the distance in metres of a point from the straight line between two others.
double distance_to(const Point2& point, const Point2& from, const Point2& to) {
    const Point2 path = to - from;
    const double part = squared_norm(path) > 0.0 ? dot(point - from, path) / squared_norm(path) : 0.0;
    return norm(from + std::clamp(part, 0.0, 1.0) * path - point);
}

} // namespace

Waypoints::Waypoints(std::vector<Point2> goals, TourStart start, Explain explain)
    : goals_(std::move(goals)), is_looking_around_(start == TourStart::kNearest), explain_(std::move(explain)) {}

Velocity Waypoints::step(const Senses& senses) {
    if (is_done()) return {};
    near_.see(senses);
    if (is_looking_around_) return look_around(senses);
    if (is_turning_) {
        const Velocity velocity = turn_.step(senses.pose);
        if (!turn_.is_done()) return velocity;
        reached_ += 1;
        go_on_to_next();
        return {};
    }
    return go(senses);
}

std::string Waypoints::remarks() const {
    std::string text = fmt::format("waypoints: {} of {} reached", reached_, goals_.size());
    if (given_up_.empty()) return text;
    text += fmt::format(", {} abandoned:", given_up_.size());
    for (std::size_t n = 0; n < std::min(given_up_.size(), kAbandonedShown); ++n) {
        const std::string why = explain_ ? explain_(given_up_[n]) : std::string();
        text += fmt::format("{} ({}, {}) {}", n > 0 ? "," : "", given_up_[n].x, given_up_[n].y,
                            why.empty() ? "no path found" : why);
    }
    if (given_up_.size() > kAbandonedShown) text += fmt::format(", and {} more", given_up_.size() - kAbandonedShown);
    return text;
}

Velocity Waypoints::look_around(const Senses& senses) {
    const Velocity velocity = turn_.step(senses.pose);
    seen_.insert(seen_.end(), senses.obstacles.begin(), senses.obstacles.end());
    if (!turn_.is_done()) return velocity;
    begin_with_nearest(position_of(senses.pose));
    seen_ = {};
    is_looking_around_ = false;
    return {};
}

void Waypoints::begin_with_nearest(const Point2& position) {
    const auto distance = [&](const Point2& goal) {
        const bool is_hidden = std::ranges::any_of(
            seen_, [&](const Point2& obstacle) { return distance_to(obstacle, position, goal) < kBodyRadius; });
        return std::pair(is_hidden, norm(goal - position));
    };
    std::rotate(goals_.begin(), std::ranges::min_element(goals_, {}, distance), goals_.end());
}

void Waypoints::go_on_to_next() {
    next_ += 1;
    is_turning_ = false;
    steps_no_nearer_ = -1;
}

Velocity Waypoints::go(const Senses& senses) {
    const Point2 position = position_of(senses.pose);
    const double distance = norm(goals_[next_] - position);
    if (distance < kArrived) {
        is_turning_ = true;
        turn_ = FullTurn();
        return turn_.step(senses.pose);
    }
    if (!has_progress(distance)) {
        given_up_.push_back(goals_[next_]);
        go_on_to_next();
        return {};
    }
    const Point2 force = potential_force(position, goals_[next_], near_.places());
    if (norm(force) < kForceMin) return {};
    const double speed = std::min(kForwardMax * std::min(1.0, norm(force)), braking_speed(distance));
    return drive_towards(senses, direction({0.0, 0.0}, force), speed);
}

bool Waypoints::has_progress(double distance) {
    if (steps_no_nearer_ < 0 || distance < nearest_ - kProgress) {
        nearest_ = distance;
        steps_no_nearer_ = 0;
        return true;
    }
    steps_no_nearer_ += 1;
    return steps_no_nearer_ < kStuckSteps;
}

} // namespace scanloom::sim

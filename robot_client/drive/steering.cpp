#include "robot_client/drive/steering.hpp"

#include "robot_client/drive/body.hpp"
#include "robot_client/drive/free_ahead.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::robot {
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

} // namespace scanloom::robot

#include "robot_client/drive/free_ahead.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scanloom::robot {
namespace {

constexpr double kTouching = kBodyRadius + 0.005; // metres
constexpr double kSecondsAhead = 0.4;             // a scan is a tenth of a second old when the next one arrives

} // namespace

double free_ahead(const Senses& senses, double yaw) {
    constexpr double kNothing = std::numeric_limits<double>::infinity();
    std::array<double, 3> nearest{kNothing, kNothing, kNothing}; // ascending
    const Point2 ahead{std::cos(yaw), std::sin(yaw)};
    for (const Point2& obstacle : senses.obstacles) {
        const Point2 offset = obstacle - Point2{senses.pose.x, senses.pose.y};
        const double forward = dot(offset, ahead);
        if (forward <= 0.0) continue;
        const double radius = norm(offset) < kKeptClear ? kTouching : kKeptClear;
        const double aside = offset.x * ahead.y - offset.y * ahead.x;
        if (std::abs(aside) >= radius) continue;
        const double free = std::max(0.0, forward - std::sqrt(radius * radius - aside * aside));
        if (free >= nearest.back()) continue;
        nearest.back() = free;
        std::ranges::sort(nearest);
    }
    return nearest.back();
}

double safe_speed(const Senses& senses, double yaw) {
    return std::min(kForwardMax, free_ahead(senses, yaw) / kSecondsAhead);
}

} // namespace scanloom::robot

#include "robot_client/drive/potential_field.hpp"

#include "robot_client/drive/body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scanloom::robot {
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

} // namespace scanloom::robot

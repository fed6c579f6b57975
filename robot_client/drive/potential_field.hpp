#pragma once

#include "common/geometry/pose2.hpp"

#include <span>

namespace scanloom::robot {

/// Computes the force of an artificial potential field on a robot, in the map frame. Its length is 1 if only a goal at
/// least one metre away acts.
///
/// The goal attracts: F = -k (x - x_goal), with k = 1 / m, limited to 1.
/// Obstacles within rho_0 = 0.5 m of the body repel, where rho is the distance from the body's rim:
///     F = eta (1 / rho - 1 / rho_0) / rho^2 away from it, the gradient of U = eta / 2 (1 / rho - 1 / rho_0)^2.
/// Each of 24 directions around the robot counts as one obstacle, its nearest, so the number of beams does not matter.
/// Source: Khatib, Real-Time Obstacle Avoidance for Manipulators and Mobile Robots, IJRR 5(1), 1986: the attractive
///         potential 1/2 k (x - x_d)^2, its velocity limited, and the FIRAS function.
[[nodiscard]] Point2 potential_force(const Point2& position, const Point2& goal, std::span<const Point2> obstacles);

} // namespace scanloom::robot

#pragma once

#include "common/geometry/pose2.hpp"

#include <span>

namespace scanloom::robot {

/// The force of an artificial potential field on a robot, all in the map frame; its length is 1 where it is drawn to a
/// goal that is a metre away or more, and by nothing else.
///
/// The goal attracts: F = -k (x - x_goal), with k = 1 / m, and never more than 1.
/// What stands within rho_0 = 0.5 m of the body repels, where rho is its distance from the body's rim:
///   F = eta (1 / rho - 1 / rho_0) / rho^2 away from it, the gradient of U = eta / 2 (1 / rho - 1 / rho_0)^2.
/// Each of 24 directions around the robot counts as one obstacle, its nearest, so that the number of beams does not
/// matter.
/// Source  Khatib, Real-Time Obstacle Avoidance for Manipulators and Mobile Robots, IJRR 5(1), 1986: the attractive
///         potential 1/2 k (x - x_d)^2, its velocity limited, and the FIRAS function.
[[nodiscard]] Point2 potential_force(const Point2& position, const Point2& goal, std::span<const Point2> obstacles);

} // namespace scanloom::robot

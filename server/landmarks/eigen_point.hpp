#pragma once

#include "common/geometry/point2.hpp"

#include <Eigen/Core>

namespace scanloom::landmarks {

[[nodiscard]] inline Eigen::Vector2d to_eigen(const Point2& point) { return {point.x, point.y}; }
[[nodiscard]] inline Point2 from_eigen(const Eigen::Vector2d& vector) { return {vector.x(), vector.y()}; }

} // namespace scanloom::landmarks

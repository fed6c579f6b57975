#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

/// The points scaled, then rotated around the origin, then moved: translation + R(rotation) * scale * point.
/// Order and number stay. Scale 1, rotation 0 and no translation give the very same coordinates.
/// @param translation   metres
/// @param rotation_rad  counter-clockwise
/// @param scale         > 0; it never mirrors
/// Errors  kInvalidField: a parameter out of its range. Those of check_points(), of the points and what they become.
[[nodiscard]] Result<std::vector<Point2>> transform_points(std::span<const Point2> points, const Point2& translation,
                                                           double rotation_rad, double scale = 1.0);

} // namespace scanloom::landmarks

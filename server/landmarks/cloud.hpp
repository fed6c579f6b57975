#pragma once

#include "common/error/error.hpp"
#include "common/geometry/pose2.hpp"

#include <span>
#include <vector>

namespace scanloom::landmarks {

/// Scales points, rotates them around the origin, then translates them: translation + R(rotation) * scale * point.
///
/// Keeps the order and number of points. Scale 1, rotation 0 and translation 0 return identical coordinates.
/// @param translation   metres
/// @param rotation_rad  counter-clockwise
/// @param scale         more than 0; does not mirror
/// Errors: kInvalidField for a parameter out of range; those of check_points(), for the points and for the results.
[[nodiscard]] Result<std::vector<Point2>> transform_points(std::span<const Point2> points, const Point2& translation,
                                                           double rotation_rad, double scale = 1.0);

} // namespace scanloom::landmarks

#pragma once

#include "common/geometry/pose2.hpp"
#include "tests/support/angles.hpp"

#include <cmath>

namespace scanloom::landmarks {

/// Returns the distance between two poses (m).
inline double metres_off(const Pose2& a, const Pose2& b) { return std::hypot(a.x - b.x, a.y - b.y); }
/// Returns the angle between the headings of two poses (degrees).
inline double degrees_off(const Pose2& a, const Pose2& b) { return std::abs(normalize_angle(a.yaw - b.yaw)) / kDegree; }

} // namespace scanloom::landmarks

#pragma once

#include "common/geometry/pose2.hpp"

#include <string_view>
#include <vector>

namespace scanloom::robot {

/// A round tour of one of the worlds of find_world(), from waypoint to waypoint, each in sight of the one before:
/// metres in the world frame. Empty for a world that has none.
[[nodiscard]] std::vector<Point2> tour_of(std::string_view world);

} // namespace scanloom::robot

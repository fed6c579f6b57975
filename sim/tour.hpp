#pragma once

#include "common/geometry/pose2.hpp"

#include <string_view>
#include <vector>

namespace scanloom::robot {

/// Returns a round tour of a world of find_world(): waypoints, each in sight of the one before, in metres in the world
/// frame. Empty if the world has no tour.
[[nodiscard]] std::vector<Point2> tour_of(std::string_view world);

} // namespace scanloom::robot

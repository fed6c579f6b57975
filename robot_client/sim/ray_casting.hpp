#pragma once

#include "robot_client/sim/world.hpp"

#include <span>
#include <vector>

namespace scanloom::robot {

/// The segments that come within `radius` metres of a point: all that a sensor of that range can see there.
[[nodiscard]] std::vector<Segment> segments_near(std::span<const Segment> segments, const Point2& point, double radius);

/// Metres from `origin` along `yaw_rad` to the first segment; infinite when there is none.
/// Exact but for rounding. The ends of a segment belong to it, so walls that meet are closed.
[[nodiscard]] double cast_ray(std::span<const Segment> segments, const Point2& origin, double yaw_rad);

/// The same for a disc; from inside it, to where the ray leaves it.
[[nodiscard]] double cast_ray(const Disc& disc, const Point2& origin, double yaw_rad);

} // namespace scanloom::robot

#pragma once

#include "robot_client/sim/shapes.hpp"

#include <span>

namespace scanloom::robot {

/// A half line.
struct Ray {
    Ray(const Point2& from, double yaw_rad);

    double origin_x; ///< metres
    double origin_y;
    double direction_x; ///< a unit vector
    double direction_y;
};

/// Metres along the ray to the segment, where it is nearer than `nearest`; otherwise `nearest`.
/// Exact but for rounding. The ends of a segment belong to it, so walls that meet are closed.
[[nodiscard]] double cast_ray(const Segment& segment, const Ray& ray, double nearest) noexcept;

/// Metres from `origin` along `yaw_rad` to the first of some segments; infinite when there is none. Looks at all of
/// them: see Obstacles for many.
[[nodiscard]] double cast_ray(std::span<const Segment> segments, const Point2& origin, double yaw_rad);

/// The same for a disc; from inside it, to where the ray leaves it.
[[nodiscard]] double cast_ray(const Disc& disc, const Point2& origin, double yaw_rad);

} // namespace scanloom::robot

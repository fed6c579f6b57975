#pragma once

#include "sim/shapes.hpp"

#include <span>

namespace scanloom::sim {

/// A half-line.
struct Ray {
    Ray(const Point2& from, double yaw_rad);

    double origin_x; ///< metres
    double origin_y;
    double direction_x; ///< a unit vector
    double direction_y;
};

/// Returns the distance in metres along the ray to the segment if it is less than `nearest`, else `nearest`. Exact
/// except for rounding. The ends of a segment belong to it, so walls that meet are closed.
[[nodiscard]] double cast_ray(const Segment& segment, const Ray& ray, double nearest) noexcept;

/// Returns the distance in metres from `origin` along `yaw_rad` to the first of the segments; infinite if there is
/// none. Checks all segments; use Obstacles for many.
[[nodiscard]] double cast_ray(std::span<const Segment> segments, const Point2& origin, double yaw_rad);

/// Returns the distance in metres from `origin` along `yaw_rad` to a disc; from inside it, to where the ray leaves it.
/// Infinite if the ray misses it.
[[nodiscard]] double cast_ray(const Disc& disc, const Point2& origin, double yaw_rad);

/// The measuring range of a sonar: everything between two directions. Metres and radians, in the world frame.
struct Cone {
    Cone(const Point2& apex_m, double yaw_rad, double aperture_rad);

    Point2 apex;
    double yaw;      ///< of its axis
    double half;     ///< half of its aperture; less than a right angle
    Point2 left_end; ///< unit vectors along its borders
    Point2 right_end;
};

/// Returns the distance in metres from the apex to the nearest point of the shape inside the cone, borders included;
/// infinite if there is none. That point cannot be occluded, because an occluding point would be nearer. Exact except
/// for rounding.
[[nodiscard]] double distance_within(const Cone& cone, const Segment& segment);
[[nodiscard]] double distance_within(const Cone& cone, const Disc& disc);

} // namespace scanloom::sim

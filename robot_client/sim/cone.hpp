#pragma once

#include "robot_client/sim/shapes.hpp"

namespace scanloom::robot {

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

} // namespace scanloom::robot

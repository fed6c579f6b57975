#pragma once

#include "robot_client/sim/shapes.hpp"

namespace scanloom::robot {

/// What a sonar hears: everything between two directions. Metres and radians, in the world frame.
struct Cone {
    Cone(const Point2& apex_m, double yaw_rad, double aperture_rad);

    Point2 apex;
    double yaw;      ///< of its axis
    double half;     ///< of its aperture; below a right angle
    Point2 left_end; ///< unit vectors along its borders
    Point2 right_end;
};

/// Metres from the apex to the nearest point of the shape that lies in the cone, borders included; infinite where none
/// does. Nothing can hide that point: what stood before it would be nearer. Exact but for rounding.
[[nodiscard]] double distance_within(const Cone& cone, const Segment& segment);
[[nodiscard]] double distance_within(const Cone& cone, const Disc& disc);

} // namespace scanloom::robot

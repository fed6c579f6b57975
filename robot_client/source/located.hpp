#pragma once

#include "common/geometry/pose2.hpp"

namespace scanloom::robot {

/// Where a robot's odometry frame is in the map, and how sure that is.
struct Located {
    Pose2 T_map_odom;
    double explained = 0.0;      ///< part of what the robot saw that lies on what the map has, 0 to 1
    double position_sigma = 0.0; ///< metres, in the direction least known
    double yaw_sigma = 0.0;      ///< radians
};

} // namespace scanloom::robot

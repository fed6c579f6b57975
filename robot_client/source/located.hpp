#pragma once

#include "common/geometry/pose2.hpp"

namespace scanloom::robot {

/// Pose of a robot's odometry frame in the map, with its uncertainty.
struct Located {
    Pose2 T_map_odom;
    double explained = 0.0;      ///< inlier ratio: share of the observed points that match the map, 0 to 1
    double position_sigma = 0.0; ///< metres; standard deviation in the least certain direction
    double yaw_sigma = 0.0;      ///< radians
};

} // namespace scanloom::robot

#pragma once

#include "common/geometry/pose2.hpp"
#include "sim/drive/behaviour.hpp"
#include "sim/world.hpp"

namespace scanloom::robot {

/// The motion of a body in one step, as odometry measures it: along its heading and around itself.
struct Motion {
    double forward = 0.0; ///< metres along the arc
    double turn = 0.0;    ///< radians

    friend bool operator==(const Motion&, const Motion&) = default;
};

/// Integrates x' = v cos yaw, y' = v sin yaw, yaw' = w exactly for constant v and w.
[[nodiscard]] Pose2 moved(const Pose2& pose, const Motion& motion);

/// Returns the robot's motion in one control period, with the velocity limited to what it can do. A body that would
/// touch a solid or a walker does not advance; it may still turn, because it is round.
[[nodiscard]] Motion drive(const World& world, const Pose2& pose, const Velocity& wanted);

} // namespace scanloom::robot

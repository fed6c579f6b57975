#pragma once

#include "common/geometry/pose2.hpp"
#include "robot_client/drive/behaviour.hpp"
#include "robot_client/drive/body.hpp"
#include "robot_client/sim/world.hpp"

namespace scanloom::robot {

/// What a body did in one step, as its wheels would tell: along its heading and around itself.
struct Motion {
    double forward = 0.0; ///< metres along the arc
    double turn = 0.0;    ///< radians

    friend bool operator==(const Motion&, const Motion&) = default;
};

/// x' = v cos yaw, y' = v sin yaw, yaw' = w, solved exactly for constant v and w.
[[nodiscard]] Pose2 moved(const Pose2& pose, const Motion& motion);

/// What the robot does in one control period, its velocity cut to what it can.
/// A body that would touch a solid or a walker does not advance; it may still turn, being round.
[[nodiscard]] Motion drive(const World& world, const Pose2& pose, const Velocity& wanted);

} // namespace scanloom::robot

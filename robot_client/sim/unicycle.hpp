#pragma once

#include "common/geometry/pose2.hpp"
#include "robot_client/drive/behaviour.hpp"
#include "robot_client/sim/world.hpp"

#include <numbers>

namespace scanloom::robot {

/// The reference robot's body: a disc with a differential drive. (Wheelbase 0.230 m, wheel radius 0.035 m; the
/// unicycle model needs neither.)
inline constexpr double kBodyRadius = 0.15;          ///< metres
inline constexpr double kForwardMax = 0.70;          ///< metres a second
inline constexpr double kTurnMax = std::numbers::pi; ///< radians a second
inline constexpr double kControlPeriod = 0.05;       ///< seconds: 20 Hz

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

#include "sim/unicycle.hpp"

#include <algorithm>
#include <cmath>

namespace scanloom::robot {

Pose2 moved(const Pose2& pose, const Motion& motion) {
    // The chord of an arc: as long as the arc if it is straight, and turned by half of its angle.
    const double half = motion.turn / 2.0;
    const double chord = std::abs(half) < 1e-9 ? motion.forward : motion.forward * std::sin(half) / half;
    return {pose.x + chord * std::cos(pose.yaw + half), pose.y + chord * std::sin(pose.yaw + half),
            normalize_angle(pose.yaw + motion.turn)};
}

Motion drive(const World& world, const Pose2& pose, const Velocity& wanted) {
    Motion motion{std::clamp(wanted.forward, -kForwardMax, kForwardMax) * kControlPeriod,
                  std::clamp(wanted.turn, -kTurnMax, kTurnMax) * kControlPeriod};
    // A step is at most 0.035 m, less than the body's radius, so nothing can pass between two checks.
    const Pose2 next = moved(pose, motion);
    if (clearance(world, {next.x, next.y}) < kBodyRadius) motion.forward = 0.0;
    return motion;
}

} // namespace scanloom::robot

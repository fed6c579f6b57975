#include "robot_client/drive/wall_follower.hpp"

#include <algorithm>
#include <numbers>

namespace scanloom::robot {
namespace {

// metres
constexpr double kStopRange = 0.25;
constexpr double kBackOffRange = 0.35;
constexpr double kFrontRange = 0.4;
constexpr double kRecoveredRange = 0.4;
constexpr double kWallRange = 0.7;
constexpr double kWallDistance = 0.6;
// metres a second
constexpr double kCruise = 0.4;
constexpr double kBackOff = -0.2;
constexpr double kRecovery = -0.08;
// radians a second
constexpr double kTurnMax = std::numbers::pi / 4.0;
constexpr double kSearchTurn = -0.05;
constexpr double kWallGain = 0.5; // radians a second for each metre
// control steps
constexpr int kRecoverySteps = 40;
constexpr int kBlockedStepsMax = 30;

} // namespace

Velocity WallFollower::step(const SectorRanges& nearest) {
    const double d_min = std::min({nearest.right, nearest.front, nearest.left});
    if (recovery_steps_left_ > 0) {
        --recovery_steps_left_;
        if (d_min > kRecoveredRange) recovery_steps_left_ = 0;
        return {kRecovery, -0.6 * kTurnMax};
    }
    if (d_min < kStopRange) {
        if (++blocked_steps_ > kBlockedStepsMax) {
            blocked_steps_ = 0;
            recovery_steps_left_ = kRecoverySteps;
        }
        return {0.0, 0.0};
    }
    blocked_steps_ = 0;
    // Backing off turns left, too: straight back, a robot beside a wall keeps its distance from it and never gets free.
    if (d_min < kBackOffRange) return {kBackOff, kTurnMax};
    if (nearest.front < kFrontRange) return {0.0, kTurnMax};
    // Positive turns are counter-clockwise: away from the wall when it is nearer than wanted, towards it when farther.
    // (Printed as 0.5 (d_right - 0.6), which would leave a wall that is farther than 0.6 m.)
    if (nearest.right < kWallRange) return {kCruise, kWallGain * (kWallDistance - nearest.right)};
    return {kCruise, kSearchTurn};
}

} // namespace scanloom::robot

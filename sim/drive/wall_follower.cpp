#include "sim/drive/wall_follower.hpp"

#include <algorithm>
#include <numbers>

namespace scanloom::sim {
namespace {

// metres
constexpr double kStopRange = 0.25;
constexpr double kBackOffRange = 0.35;
constexpr double kFrontRange = 0.4;
constexpr double kRecoveredRange = 0.4;
constexpr double kWallRange = 0.7;
constexpr double kWallDistance = 0.6;
constexpr double kRoundingRadius = 0.55; // a little less than the wall distance, so that the wall comes near again
// metres per second
constexpr double kCruise = 0.4;
constexpr double kBackOff = -0.2;
constexpr double kRecovery = -0.08;
constexpr double kRoundingSpeed = 0.3;
// radians per second
constexpr double kSharpTurn = std::numbers::pi / 4.0;
constexpr double kSearchTurn = -0.05;
constexpr double kWallGain = 0.5; // radians per second for each metre
// control steps
constexpr double kStepsPerSecond = 20.0;
constexpr int kRecoverySteps = 40;
constexpr int kBlockedStepsMax = 30;
constexpr int kRoundingStepsMax = 180; // about three quarters of a circle
// radians
constexpr double kIslandTurn = -2.5 * std::numbers::pi; // more than passing a door post takes, in and out

} // namespace

Velocity WallFollower::step(const Senses& senses) {
    const Velocity velocity = decide(senses.nearest);
    turned_ += velocity.turn / kStepsPerSecond;
    if (turned_ < kIslandTurn && mode_ != Mode::kSearching) mode_ = Mode::kLeaving;
    return velocity;
}

Velocity WallFollower::decide(const SectorRanges& nearest) {
    const double d_min = std::min({nearest.right, nearest.front, nearest.left});
    if (recovery_steps_left_ > 0) {
        --recovery_steps_left_;
        if (d_min > kRecoveredRange) recovery_steps_left_ = 0;
        return {kRecovery, -0.6 * kSharpTurn};
    }
    if (d_min < kStopRange) {
        if (++blocked_steps_ > kBlockedStepsMax) {
            blocked_steps_ = 0;
            recovery_steps_left_ = kRecoverySteps;
        }
        return {0.0, 0.0};
    }
    blocked_steps_ = 0;
    if (d_min < kBackOffRange || nearest.front < kFrontRange) {
        if (mode_ == Mode::kLeaving) search(); // another wall was found
        // Turn left while backing off: a robot next to a wall that backs straight keeps its distance from the wall and
        // never recovers.
        return {d_min < kBackOffRange ? kBackOff : 0.0, kSharpTurn};
    }
    return go_on(nearest.right);
}

Velocity WallFollower::go_on(double right) {
    if (mode_ == Mode::kLeaving) return {kCruise, 0.0};
    if (right < (mode_ == Mode::kRounding ? kWallDistance : kWallRange)) {
        mode_ = Mode::kFollowing;
        // Positive turns are counter-clockwise: away from the wall if it is nearer than wanted, towards it if it is
        // farther. (Printed as 0.5 (d_right - 0.6), which would leave a wall that is farther than 0.6 m.)
        return {kCruise, kWallGain * (kWallDistance - right)};
    }
    if (mode_ == Mode::kFollowing) {
        mode_ = Mode::kRounding;
        rounding_steps_left_ = kRoundingStepsMax;
    }
    if (mode_ == Mode::kRounding && rounding_steps_left_-- > 0)
        return {kRoundingSpeed, -kRoundingSpeed / kRoundingRadius};
    search();
    return {kCruise, kSearchTurn};
}

void WallFollower::search() {
    mode_ = Mode::kSearching;
    turned_ = 0.0;
}

} // namespace scanloom::sim

#pragma once

#include "robot_client/drive/behaviour.hpp"

namespace scanloom::robot {

/// Follows the wall on its right hand at 0.6 m, and frees itself when it has come too close to something.
///
/// The rules, the first that applies wins:
///   1. recovering: back off slowly, turning right, for at most 40 steps or until 0.4 m are free all round;
///   2. nearer than 0.25 m to anything: stop; after 30 such steps begin to recover;
///   3. nearer than 0.35 m: back off, turning left; less than 0.4 m ahead: turn left on the spot;
///   4. a wall within 0.7 m on the right: keep it at 0.6 m; else straight on, bearing gently right.
class WallFollower final : public Behaviour {
public:
    [[nodiscard]] Velocity step(const SectorRanges& nearest) override;

private:
    int recovery_steps_left_ = 0;
    int blocked_steps_ = 0;
};

} // namespace scanloom::robot

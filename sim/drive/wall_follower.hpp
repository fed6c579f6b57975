#pragma once

#include "sim/drive/behaviour.hpp"

namespace scanloom::sim {

/// Follows the wall on its right at 0.6 m, around its ends and through doors, and recovers when it has come too close
/// to something.
///
/// Rules; the first that applies is used:
///   1. recovering: back off slowly, turning right, for at most 40 steps or until 0.4 m are free all round;
///   2. nearer than 0.25 m to anything: stop; after 30 such steps begin to recover;
///   3. nearer than 0.35 m: back off, turning left; less than 0.4 m ahead: turn left on the spot;
///   4. leaving an island: straight on until rule 3 finds another wall;
///   5. a wall within 0.7 m on the right: keep it at 0.6 m; where it ends, go around its end for at most nine seconds;
///      otherwise straight on, turning slightly right.
/// A robot that follows the walls of a room from inside turns left in total, around a table or a block of rooms it
/// turns right. If it turns right by more than a full circle, the obstacle is an island, and the robot leaves it.
class WallFollower final : public Behaviour {
public:
    [[nodiscard]] Velocity step(const Senses& senses) override;

private:
    enum class Mode { kSearching, kFollowing, kRounding, kLeaving };

    [[nodiscard]] Velocity decide(const SectorRanges& nearest);
    [[nodiscard]] Velocity go_on(double right);
    void search();

    Mode mode_ = Mode::kSearching;
    double turned_ = 0.0; ///< since a wall was found; radians, counter-clockwise
    int rounding_steps_left_ = 0;
    int recovery_steps_left_ = 0;
    int blocked_steps_ = 0;
};

} // namespace scanloom::sim

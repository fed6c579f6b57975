#pragma once

#include "sim/drive/behaviour.hpp"
#include "sim/drive/path_follower.hpp"

#include <cstdint>
#include <vector>

namespace scanloom::sim {

/// Drives to the goals it is given and observes the target there, until exploration is finished: first a full turn at
/// the start, then path after path. It does not know the source of the goals: while needs_goal(), its caller calls one
/// of go(), wait() and finish().
class Explore final : public Behaviour {
public:
    /// Distance in metres that paths should keep from obstacles. It is requested as the radius of the body, which is
    /// 0.15 m. It is the sum of kKeptClear, 0.17 m, the distance that the robot's centre keeps from what it sees, and
    /// 0.05 m for noise (sigma 0.02 m) and corners (passed by 0.03 m). Paths nearer to obstacles can be driven, but
    /// only more slowly: in exploring_robot_test the robot explores as much with 0.15 m and touches nothing either, but
    /// the office takes it 17 to 21 minutes instead of 15 to 17. The cost: passages narrower than 0.44 m are not
    /// explored, although the body would fit through those of 0.3 m.
    static constexpr double kPathClearance = 0.22;

    [[nodiscard]] Velocity step(const Senses& senses) override;
    [[nodiscard]] bool is_done() const override { return task_ == Task::kDone; }
    [[nodiscard]] bool has_an_end() const override { return true; }
    [[nodiscard]] std::string remarks() const override;

    /// Returns whether the robot stands and waits for a goal: it has observed the last target or cannot reach it.
    [[nodiscard]] bool needs_goal() const noexcept { return task_ == Task::kNeedGoal; }

    /// Drives to the end of a path and turns to the target there. Metres in the map frame.
    void go(std::vector<Point2> path, const Point2& target);

    /// Leaves the path, makes a full turn, then asks again.
    void look_around();

    /// Stands for some time, then asks again.
    void wait(double seconds);

    /// Finishes: there is nothing left to explore.
    void finish() { task_ = Task::kDone; }

    /// Returns how many times in a row a given path was blocked at nearly the same place.
    [[nodiscard]] int times_blocked() const noexcept { return times_blocked_; }

private:
    enum class Task { kLookAround, kNeedGoal, kGo, kLook, kGetFree, kWait, kDone };

    [[nodiscard]] Velocity go_on(const Senses& senses);
    void request_another_path(const Senses& senses);
    void note(const Point2& position);

    Task task_ = Task::kLookAround;
    FullTurn turn_;
    PathFollower follower_;
    Point2 target_{0.0, 0.0};
    int steps_left_ = 0; // to wait
    bool has_begun_ = false;
    Point2 last_{0.0, 0.0};
    double driven_ = 0.0;
    std::uint64_t steps_ = 0;
    int times_blocked_ = 0;
    Point2 blocked_at_{0.0, 0.0};
};

} // namespace scanloom::sim

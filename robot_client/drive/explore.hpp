#pragma once

#include "robot_client/drive/behaviour.hpp"
#include "robot_client/drive/path_follower.hpp"
#include "robot_client/drive/steering.hpp"

#include <cstdint>
#include <vector>

namespace scanloom::robot {

/// Goes where it is told and looks there, until it is told that there is nothing left to explore: a full turn where it
/// starts, then way after way. It does not know who tells it: while is_asking(), whoever drives it calls one of go(),
/// wait() and finish().
class Explore final : public Behaviour {
public:
    /// Metres that ways should keep from obstacles: what it asks for as the radius of its body, which is 0.15 m. It is
    /// kKeptClear, 0.17 m, nearer than which its centre does not go to what it sees, and 0.05 m for what noise
    /// (sigma 0.02 m) and corners (passed by 0.03 m) take of a way. Nearer ways can be driven, only
    /// more slowly: in exploring_robot_test it explores as much with 0.15 m and touches nothing either, yet the
    /// office takes it 17 to 21 minutes instead of 15 to 17. The price: passages narrower than 0.44 m are not explored,
    /// though the body would fit through those of 0.3 m.
    static constexpr double kWayClearance = 0.22;

    [[nodiscard]] Velocity step(const Senses& senses) override;
    [[nodiscard]] bool is_done() const override { return task_ == Task::kDone; }
    [[nodiscard]] bool has_an_end() const override { return true; }
    [[nodiscard]] std::string remarks() const override;

    /// It stands, and wants to be told what to do: it has looked where it was sent, or cannot get there.
    [[nodiscard]] bool is_asking() const noexcept { return task_ == Task::kAsk; }

    /// To the end of a way, and there a turn to the target. Metres, in the map frame.
    void go(std::vector<Point2> way, const Point2& target);

    /// Stands for some time and asks again.
    void wait(double seconds);

    /// There is nothing left to explore.
    void finish() { task_ = Task::kDone; }

    [[nodiscard]] double driven_m() const noexcept { return driven_; }
    [[nodiscard]] double driven_s() const noexcept;
    /// How many times in a row something was in a way that it had been given, nearly where the robot was before.
    [[nodiscard]] int times_blocked() const noexcept { return times_blocked_; }

private:
    enum class Task { kLookAround, kAsk, kGo, kLook, kGetFree, kWait, kDone };

    [[nodiscard]] Velocity go_on(const Senses& senses);
    void ask_another_way(const Senses& senses);
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

} // namespace scanloom::robot

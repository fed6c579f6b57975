#pragma once

#include "robot_client/sources/live_source.hpp"
#include "robot_client/sources/wake_signal.hpp"
#include "sim/drive/explore.hpp"
#include "sim/robot/simulated_source.hpp"
#include "sim/simulator.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::sim {

/// A simulated robot that explores a world and goes where the server directs it, until exploration is complete or the
/// first of its limits is reached. The simulation stands still while a reply is awaited, so the same replies give the
/// same scans. After a reply with an error the robot asks again after one second of simulated time, at most ten times
/// in a row.
///
/// Threads: as for LiveSource.
class ExploringSource final : public robot::LiveSource {
public:
    /// @param speed  of the simulation, as a multiple of real time; 0 = as fast as scans are taken
    ExploringSource(SimulatorOptions options, SimulationLimits limits, robot::NoReturn no_return, double speed);

    /// Sets the function that returns the next goal. Call it before the first next().
    void ask_with(robot::NextGoal next_goal) { next_goal_ = std::move(next_goal); }

    /// Lets the robot steer by a correction of the server; see Simulator::correct(). When the server has lost the
    /// robot, it leaves its path, looks around and asks for a goal again.
    void correct(const Pose2& T_map_odom, LocalizationState state);

    [[nodiscard]] bool can_wait() const override { return true; }
    /// Stamps continue after those of the stored scans, and limits count those scans. The robot itself starts at its
    /// usual start.
    void resume_after(std::uint64_t scans) override { resumed_after_ = scans; }

    /// Errors: the last of ten failed replies; kNoPath if something blocks the robot wherever it is sent.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<robot::Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override { return explore_->remarks(); }

    [[nodiscard]] const Simulator& simulator() const noexcept { return simulator_; }

private:
    using Clock = std::chrono::steady_clock;

    ExploringSource(SimulatorOptions options, SimulationLimits limits, robot::NoReturn no_return, double speed,
                    std::unique_ptr<Explore> explore);

    [[nodiscard]] boost::asio::awaitable<Result<>> request_goal();
    [[nodiscard]] Result<> take(Result<robot::NextStop> answer);
    [[nodiscard]] boost::asio::awaitable<void> wait_until_due(double stamp);

    Explore* explore_; // owned by the simulator
    Simulator simulator_;
    SimulationLimits limits_;
    robot::NoReturn no_return_;
    double speed_;
    robot::NextGoal next_goal_;
    std::uint64_t resumed_after_ = 0;
    std::uint64_t scans_ = 0; // of this run
    double stamp_ = -1.0;     // of the newest scan
    int failures_ = 0;        // in a row
    bool is_lost_ = false;
    bool is_stopped_ = false;
    robot::WakeSignal wake_;
    Clock::time_point due_ = Clock::time_point::min();
};

} // namespace scanloom::sim

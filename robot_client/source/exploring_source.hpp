#pragma once

#include "robot_client/drive/explore.hpp"
#include "robot_client/sim/simulator.hpp"
#include "robot_client/source/live_source.hpp"
#include "robot_client/source/next_goal.hpp"
#include "robot_client/source/simulated_source.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/steady_timer.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::robot {

/// A simulated robot that explores a world where it is told to, until that is complete or the first of its limits.
/// The world stands still while an answer is awaited: the same answers give the same scans. An answer that is an error
/// is asked for again after a second of the simulation, ten times in a row at most.
///
/// Thread  as of LiveSource
class ExploringSource final : public LiveSource {
public:
    /// @param speed  of the simulation, as a multiple of real time; 0 = as fast as scans are taken
    ExploringSource(SimulatorOptions options, SimulationLimits limits, NoReturn no_return, double speed);

    /// Who tells where to go. To be called before the first next().
    void ask_with(NextGoal next_goal) { next_goal_ = std::move(next_goal); }

    [[nodiscard]] bool can_wait() const override { return true; }
    /// Stamps go on behind those of the scans that are stored, and limits count them. The robot itself begins where it
    /// always begins.
    void resume_after(std::uint64_t scans) override { resumed_after_ = scans; }

    /// Errors  the last of ten answers that were errors. kNoPath: something blocks the robot wherever it is sent.
    [[nodiscard]] boost::asio::awaitable<Result<std::optional<Observation>>> next() override;
    void stop() override;
    [[nodiscard]] std::string remarks() const override { return explore_->remarks(); }

    [[nodiscard]] const Simulator& simulator() const noexcept { return simulator_; }

private:
    using Clock = std::chrono::steady_clock;

    ExploringSource(SimulatorOptions options, SimulationLimits limits, NoReturn no_return, double speed,
                    std::unique_ptr<Explore> explore);

    [[nodiscard]] boost::asio::awaitable<Result<>> ask();
    [[nodiscard]] Result<> take(Result<NextStop> answer);
    [[nodiscard]] boost::asio::awaitable<void> wait_until_due(double stamp);
    [[nodiscard]] boost::asio::awaitable<void> until_stopped();

    Explore* explore_; // the simulator has it
    Simulator simulator_;
    SimulationLimits limits_;
    NoReturn no_return_;
    double speed_;
    NextGoal next_goal_;
    std::uint64_t resumed_after_ = 0;
    std::uint64_t scans_ = 0; // of this run
    double stamp_ = -1.0;     // of the newest scan
    int failures_ = 0;        // in a row
    bool is_stopped_ = false;
    std::optional<boost::asio::steady_timer> wake_; // while next() waits
    Clock::time_point due_ = Clock::time_point::min();
};

} // namespace scanloom::robot

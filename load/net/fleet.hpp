#pragma once

#include "load/core/fault_schedule.hpp"
#include "load/core/figures.hpp"
#include "load/net/robot.hpp"
#include "load/net/run_clock.hpp"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::load {

/// What the robots of all threads do.
struct FleetPlan {
    std::uint32_t robots = 0;
    double connections_per_second = 0.0;
    std::uint64_t scans = 0; ///< of each robot, by the workload's schedule
    Micros duration = 0;     ///< used if the workload has no schedule
    FaultMeans faults{};
    std::uint64_t seed = 0;
    std::uint32_t threads = 1;
};

/// The robots of one thread: every `threads`-th of all. One timer follows the schedule of all of them and notifies each
/// robot when a scan is due; robots need no timer for that.
///
/// Threads: begin(), end() and look() may be called from any; everything else happens on the shard's own.
class Shard {
public:
    struct Look {
        FleetFigures figures;
        Troubles troubles;
    };

    /// Progress of the robots: figures without histograms, which are large.
    struct Progress : FleetCounts {
        std::string trouble; ///< the most recent one

        void add(const Progress& other);
    };

    /// Opens no connection yet. `all` are the robots of all shards; the references must outlive this object.
    Shard(std::uint32_t number, const FleetPlan& plan, const std::vector<RobotPlan>& all, const RunClock& clock,
          const Workload& workload, const RobotLinkOptions& link);
    ~Shard();
    Shard(const Shard&) = delete;
    Shard& operator=(const Shard&) = delete;

    /// Connects the robots at the planned rate.
    void connect();
    /// The robots send from `start` on.
    void begin(Micros start);
    /// Scans that are not due yet are never sent.
    void end();
    /// Closes all connections and ends the thread.
    void stop();

    /// Returns the current statistics; waits for the shard's thread.
    [[nodiscard]] std::unique_ptr<Look> look();
    [[nodiscard]] Progress progress();

    /// Pre: stop() was called.
    [[nodiscard]] const std::vector<std::unique_ptr<Robot>>& robots() const noexcept { return robots_; }

private:
    [[nodiscard]] boost::asio::awaitable<void> connect_all();
    [[nodiscard]] boost::asio::awaitable<void> follow_schedule(Micros start);
    [[nodiscard]] boost::asio::awaitable<void> send_without_pause(Micros start);
    [[nodiscard]] boost::asio::awaitable<void> strike_at_random();
    [[nodiscard]] boost::asio::awaitable<void> look_after_all();
    [[nodiscard]] bool hand_out_due(Micros start);
    template <class Function>
    [[nodiscard]] auto on_thread(Function function);
    void end_all();

    const std::uint32_t number_;
    const FleetPlan plan_;
    const RunClock& clock_;
    const Workload& workload_;
    FleetFigures figures_;
    Troubles troubles_;
    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    std::vector<std::unique_ptr<Robot>> robots_;
    std::uint64_t place_ = 0; // next position in the schedule
    bool ended_ = false;
    std::thread thread_;
};

/// Spreads robots over sessions: robot i joins session i % sessions. The robots of a session start evenly spaced on the
/// workload, so that sessions with equally many robots receive the same scans.
[[nodiscard]] std::vector<RobotPlan> spread_over(const std::vector<std::string>& sessions, std::uint32_t robots,
                                                 std::size_t workload_scans);

/// All robots, on as many threads as planned.
/// Threads: one at a time.
class Fleet {
public:
    /// The references must outlive this object.
    Fleet(const FleetPlan& plan, const std::vector<RobotPlan>& robots, const RunClock& clock, const Workload& workload,
          const RobotLinkOptions& link);

    void connect();
    void begin(Micros start);
    void end();
    void stop();

    [[nodiscard]] std::unique_ptr<Shard::Look> look();
    [[nodiscard]] Shard::Progress progress();

    /// Returns the number of acknowledged scans of each robot.
    /// Pre: stop() was called.
    [[nodiscard]] std::vector<std::uint64_t> acknowledged() const;

private:
    std::vector<std::unique_ptr<Shard>> shards_;
};

} // namespace scanloom::load

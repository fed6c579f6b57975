#pragma once

#include "load/core/fault_schedule.hpp"
#include "load/core/fleet_figures.hpp"
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

/// How the robots of all threads together behave.
struct FleetPlan {
    std::uint32_t robots = 0;
    double connections_per_second = 0.0;
    std::uint64_t scans = 0; ///< of each robot, by the course's schedule
    Micros duration = 0;     ///< where the course has no schedule
    FaultMeans faults{};
    std::uint64_t seed = 0;
    std::uint32_t threads = 1;
};

/// The robots of one thread: each that comes `threads` after the one before. One timer goes through the schedule of all
/// and tells each robot when it has a scan; there is none for each.
///
/// Thread  begin(), end(), and look() may be called from any; everything else happens on its own.
class Shard {
public:
    struct Look {
        FleetFigures figures;
        Troubles troubles;
    };

    /// How far the robots are.
    struct Progress {
        std::uint32_t linked = 0;
        std::uint32_t greeted = 0;
        std::uint32_t finished = 0;
        std::uint32_t failed = 0;
        std::uint64_t acknowledged = 0;
        std::string trouble; ///< the newest

        void add(const Progress& other);
    };

    /// Makes no connection yet. `all` are the robots of all shards; the references stay until this is gone.
    Shard(std::uint32_t number, const FleetPlan& plan, const std::vector<RobotPlan>& all, const RunClock& clock,
          const Course& course, const RobotLinkOptions& link);
    ~Shard();
    Shard(const Shard&) = delete;
    Shard& operator=(const Shard&) = delete;

    /// Connects the robots, so many a second.
    void connect();
    /// Lets them send from then on.
    void begin(Micros start);
    /// Whatever was not due yet never is.
    void end();
    /// Closes everything, and ends the thread.
    void stop();

    /// How things stand; waits for the shard's thread to tell.
    [[nodiscard]] std::unique_ptr<Look> look();
    /// The same without histograms, which are large.
    [[nodiscard]] Progress progress();

    /// Pre  stop() was called.
    [[nodiscard]] const std::vector<std::unique_ptr<Robot>>& robots() const noexcept { return robots_; }

private:
    [[nodiscard]] boost::asio::awaitable<void> connect_all();
    [[nodiscard]] boost::asio::awaitable<void> follow_schedule(Micros start);
    [[nodiscard]] boost::asio::awaitable<void> send_without_pause(Micros start);
    [[nodiscard]] boost::asio::awaitable<void> strike_at_random();
    [[nodiscard]] boost::asio::awaitable<void> look_after_all();
    [[nodiscard]] bool hand_out_due(Micros start);
    template <class Tell>
    [[nodiscard]] auto on_thread(Tell tell);
    void end_all();

    const std::uint32_t number_;
    const FleetPlan plan_;
    const RunClock& clock_;
    const Course& course_;
    FleetFigures figures_;
    Troubles troubles_;
    boost::asio::io_context io_{1};
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
    std::vector<std::unique_ptr<Robot>> robots_;
    std::uint64_t place_ = 0; // in the schedule: what is next
    bool ended_ = false;
    std::thread thread_;
};

} // namespace scanloom::load

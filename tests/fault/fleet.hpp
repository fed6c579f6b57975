#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::fault {

/// A robot whose data is all known: its scans are testing_support::random_scan(seed, 1), (seed, 2), ...
struct RobotPlan {
    std::string session;
    std::string name;
    unsigned seed = 1;
    std::uint64_t scans = 0; ///< total number
};

/// Returns plans for this number of robots: every second one is in the session "shared", the others have one session
/// each.
[[nodiscard]] std::vector<RobotPlan> half_sharing(unsigned robots, std::uint64_t seed, std::uint64_t scans);

/// Returns the options of the sessions that robots create.
[[nodiscard]] SessionOptions fleet_options();

/// The state of a robot's stream.
struct RobotStanding {
    RobotPlan plan;
    std::uint64_t acknowledged = 0; ///< highest seq acknowledged as durable
    Result<> outcome;               ///< of its uplink, after that has ended
    std::uint64_t reconnects = 0;
};

/// A robot's timeouts. The defaults make a lost connection cheap; the product does not promise them.
struct LinkTimeouts {
    std::chrono::milliseconds welcome{2'000};
    std::chrono::milliseconds ping_after{200};
    std::chrono::milliseconds silence_max{2'000};
    std::chrono::milliseconds give_up_after{60'000}; ///< without progress
    std::chrono::milliseconds backoff_first{2};
    std::chrono::milliseconds backoff_longest{50};
};

/// Robots in this process, each with its own uplink as in scanloom-robot, on one thread.
/// Thread  any one.
class Fleet {
public:
    /// Connects the robots to `port` of this machine; a server need not listen there yet.
    Fleet(std::vector<RobotPlan> plans, std::uint16_t port, const LinkTimeouts& timeouts = {})
        : Fleet(std::move(plans), std::vector{port}, timeouts) {}

    /// Connects the robots to several servers that share a store; the first one of each robot is another.
    Fleet(std::vector<RobotPlan> plans, const std::vector<std::uint16_t>& ports, const LinkTimeouts& timeouts = {});
    ~Fleet();

    /// Permits each robot to send its scans up to this number; none initially.
    void release(std::uint64_t seq);
    void release_all();

    /// Releases scans one after the other from now on, `rate` a second of each robot, in turn. Call once, instead of
    /// release(). Robots end after end() only.
    void stream(unsigned rate);

    /// The robots end when the released scans are acknowledged.
    void end();

    /// Waits until every robot has an acknowledgement of all scans that are released now. Pre: stream() was called.
    /// @return per robot, the longest time from a scan's release to its acknowledgement since the last call; empty: a
    ///         robot has given up
    [[nodiscard]] std::vector<std::chrono::milliseconds> wait_for_all();

    /// Waits until this number of scans is acknowledged in total.
    /// @return false if that cannot happen, as a robot has given up or all released scans are acknowledged
    bool wait_for_acknowledged(std::uint64_t scans);

    [[nodiscard]] std::uint64_t acknowledged() const;
    [[nodiscard]] bool has_given_up() const;

    /// Waits until every robot has ended. Pre: release_all() or end() was called, or a robot has given up, in which
    /// case the others are stopped.
    [[nodiscard]] std::vector<RobotStanding> finish();

private:
    class Robots;
    std::unique_ptr<Robots> robots_;
};

} // namespace scanloom::fault

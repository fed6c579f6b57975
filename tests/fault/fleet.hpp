#pragma once

#include "common/error/error.hpp"
#include "common/scan/session_options.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace scanloom::fault {

/// A robot of which everything is known: its scans are testing_support::random_scan(seed, 1), (seed, 2), ...
struct RobotPlan {
    std::string session;
    std::string name;
    unsigned seed = 1;
    std::uint64_t scans = 0; ///< in all
};

/// So many robots: every second one is in the session "shared", the others have one each.
[[nodiscard]] std::vector<RobotPlan> half_sharing(unsigned robots, std::uint64_t seed, std::uint64_t scans);

/// Of the sessions that robots make.
[[nodiscard]] SessionOptions fleet_options();

/// Where a robot stands.
struct RobotStanding {
    RobotPlan plan;
    std::uint64_t acknowledged = 0; ///< highest seq that it was told is durable
    Result<> outcome;               ///< of its uplink, once that has ended
    std::uint64_t reconnects = 0;
};

/// How soon a robot gives up waiting. The defaults make a lost link cost little; they are no promise of the product's.
struct Patience {
    std::chrono::milliseconds welcome{2'000};
    std::chrono::milliseconds ping_after{200};
    std::chrono::milliseconds silence_max{2'000};
    std::chrono::milliseconds give_up_after{60'000}; ///< without progress
    std::chrono::milliseconds backoff_first{2};
    std::chrono::milliseconds backoff_longest{50};
};

/// Robots in this process, each with an uplink of its own as scanloom-robot has, on one thread.
/// Thread  any one.
class Fleet {
public:
    /// They connect to `port` of this machine, whether somebody listens there yet or not.
    Fleet(std::vector<RobotPlan> plans, std::uint16_t port, const Patience& patience = {});
    ~Fleet();

    /// From now on each robot may send its scans up to this number; none at the beginning.
    void release(std::uint64_t seq);
    void release_all();

    /// Waits until this many scans are acknowledged in all.
    /// @return false when that can never be, as a robot has given up, or all have what they were released.
    bool wait_for_acknowledged(std::uint64_t scans);

    [[nodiscard]] std::uint64_t acknowledged() const;
    [[nodiscard]] bool has_given_up() const;

    /// Waits until every robot has ended. Pre: release_all(), or one of them has given up: then the others are
    /// stopped.
    [[nodiscard]] std::vector<RobotStanding> finish();

private:
    class Robots;
    std::unique_ptr<Robots> robots_;
};

} // namespace scanloom::fault

#pragma once

#include "lab/cluster_loads.hpp"
#include "lab/cluster_plan.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace scanloom::lab::cluster {

/// Why a robot has no acknowledgements for some time.
enum class Cause : std::uint8_t {
    kStart,   ///< it has started, with a new session
    kStopped, ///< its node was stopped
    kKilled,  ///< its node was killed
    kSilent,  ///< its node fell silent
};
inline constexpr std::array kCauses{Cause::kStart, Cause::kStopped, Cause::kKilled, Cause::kSilent};

/// Times without acknowledgements, from one cause.
struct Waits {
    std::size_t count = 0; ///< robots that waited and were welcomed, each time counted
    Time percentile_99{0}; ///< 99 of 100 robots waited at most so long
    Time longest{0};
};

/// The balance of the nodes at one moment. A share is robots on a node, divided by robots / nodes of the plan.
struct Balance {
    std::string when;
    Time time{0};
    std::size_t nodes_up = 0;
    double emptiest = 0.0; ///< smallest share of a node that runs
    double fullest = 0.0;  ///< largest share
};

/// What a simulation has found.
struct Outcome {
    std::size_t sessions = 0;                ///< at any time
    std::size_t largest_session = 0;         ///< robots
    std::size_t created = 0;                 ///< sessions, with those of the begin
    std::array<std::size_t, 3> ends{};       ///< of nodes, by End
    std::size_t taken_over = 0;              ///< sessions that were taken from a node that had failed
    std::size_t moved = 0;                   ///< sessions that were taken after a node had given them up
    std::array<Waits, kCauses.size()> waits; ///< by Cause
    std::size_t waiting = 0;                 ///< robots that still waited at the end
    std::int64_t node_robots_max = 0;        ///< robots of the fullest node ever
    double node_robots_mean = 0.0;           ///< robots of the fullest node at each time, mean over the time
    Loads::Overload overload;                ///< of nodes
    std::vector<Balance> balances;           ///< by time

    [[nodiscard]] const Waits& waits_of(Cause cause) const { return waits[static_cast<std::size_t>(cause)]; }
};

} // namespace scanloom::lab::cluster

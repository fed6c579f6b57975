#pragma once

#include "common/error/error.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>

/// A simulation of several servers (nodes) that share a database: who owns which session after failures, upgrades and
/// the end of sessions, and how the load is spread. Single scans are not simulated. Everything is pure: equal plans
/// give equal results.
namespace scanloom::lab::cluster {

using Time = std::chrono::milliseconds; ///< since the begin of the simulation, or a duration

/// What is simulated.
struct Plan {
    std::size_t robots = 10'000; ///< at least 1
    double rate_hz = 10.0;       ///< scans of a robot per second

    double session_size = 10.0;      ///< mean number of robots of a session, 1 to kSessionSizeMax
    double session_spread = 1.0;     ///< standard deviation of the logarithm of a session's size; 0: all are equal
    double session_life_hours = 8.0; ///< mean; then its robots start and create another session. 0: for ever

    std::size_t nodes = 3;
    double node_cores = 8.0;
    double node_us = 19.9;  ///< microseconds of processor time of a node for one scan
    double load_ms = 15.0;  ///< milliseconds for loading a session that another node had
    double close_ms = 20.0; ///< milliseconds for closing a session that a stopped node gives up

    double database_cores = 4.0;    ///< of a primary
    double database_mbytes = 100.0; ///< most megabytes (10^6) of log per second that a primary may write
    double primary_us = 7.4;        ///< microseconds of processor time of the primary for one scan
    double standby_us = 3.6;        ///< the same of its standby
    double log_bytes = 600.0;       ///< bytes of one scan in the log

    double failure_hours = 720.0; ///< mean time between failures of one node; 0: no failure
    double silent_share = 0.5;    ///< share of failures without an end of connections, as by loss of power
    double repair_minutes = 30.0; ///< from a failure until the node is back

    double upgrade_at_hours = 12.0; ///< then all nodes are restarted, one after another; 0: no upgrade
    double restart_s = 30.0;        ///< seconds from a stop until the node is ready, and the next one is stopped

    double duration_hours = 24.0;
    std::uint64_t seed = 1;
};

inline constexpr double kSessionSizeMax = 1024; ///< robots; the server's limit
inline constexpr double kFullShare = 0.8; ///< of the cores of a machine, or of a database's bytes: to be planned with
inline constexpr double kRobotStartsMax = 1e8; ///< of one simulation

/// Checks what the bounds of single options cannot.
/// Errors: kInvalidField: an impossible combination; the message names the options.
[[nodiscard]] Result<> check(const Plan& plan);

/// Converts hours, minutes and seconds to the unit of the simulation, rounded down.
[[nodiscard]] constexpr Time of_hours(double hours) { return Time(static_cast<std::int64_t>(hours * 3'600'000.0)); }
[[nodiscard]] constexpr Time of_minutes(double minutes) { return of_hours(minutes / 60.0); }
[[nodiscard]] constexpr Time of_seconds(double seconds) { return Time(static_cast<std::int64_t>(seconds * 1000.0)); }

/// Returns the seconds of a time.
[[nodiscard]] constexpr double in_seconds(Time time) { return std::chrono::duration<double>(time).count(); }

} // namespace scanloom::lab::cluster

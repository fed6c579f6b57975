#pragma once

#include "common/scan/poses.hpp"
#include "load/core/figures.hpp"
#include "load/core/verdict.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::load {

/// The settings of a run.
struct RunSettings {
    std::uint32_t robots = 100;
    std::uint32_t sessions = 0; ///< parse_options() replaces 0 by one per robot
    double rate = 10.0;         ///< scans per second of each robot; 0: as fast as the credit allows
    std::uint32_t batch = 1;    ///< scans per frame
    double duration = 30.0;     ///< seconds
    std::string world = "office";
    std::string laser = "reference";
    std::string noise = "none";
    Poses poses = Poses::kMap;       ///< that the robots send
    std::size_t beams = 0;           ///< per scan, by the laser
    std::optional<double> cell_size; ///< metres; absent: the server's default
    std::uint64_t seed = 1;
    std::uint32_t threads = 1;
    std::uint32_t viewers = 0;
    std::uint32_t tile_readers = 0;
    double tile_rate = 20.0; ///< tiles per second of each reader
    std::string faults_text; ///< as given on the command line
};

/// Everything that a run reports.
struct RunReport {
    RunSettings settings;
    double seconds = 0.0; ///< from the intended time of the first scan until the last acknowledgement
    FleetFigures fleet;
    AudienceFigures audience;
    double watched_seconds = 0.0;     ///< over which the use of processors was measured: somewhat longer
    ProcessUse own;                   ///< within watched_seconds, like `server`
    std::optional<ServerUsed> server; ///< absent: the server did not report it
    Evidence evidence;
    Verdict verdict;
};

/// The generator was punctual if 99 % of all scans were handed to their robots within this delay. Latencies beyond it
/// are then caused by the server and the network.
inline constexpr Micros kOwnDelayFine = 10 * kMillisecond;

/// Formats a report for people; the last line is the verdict.
[[nodiscard]] std::string to_text(const RunReport& report);

/// Formats a report for programs: one JSON object. docs/load.md lists its fields.
[[nodiscard]] std::string to_json(const RunReport& report);

} // namespace scanloom::load

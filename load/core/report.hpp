#pragma once

#include "load/core/audience_figures.hpp"
#include "load/core/fleet_figures.hpp"
#include "load/core/process_use.hpp"
#include "load/core/verdict.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::load {

/// What was asked of a run.
struct RunSettings {
    std::uint32_t robots = 0;
    std::uint32_t sessions = 0;
    double rate = 0.0; ///< scans a second of each robot; 0: as fast as the credit allows
    std::uint32_t batch = 1;
    double duration = 0.0; ///< seconds
    std::string world;
    std::string laser;
    std::string noise;
    std::size_t beams = 0;           ///< of a scan
    std::optional<double> cell_size; ///< metres; absent: the server's default
    std::uint64_t seed = 0;
    std::uint32_t threads = 1;
    std::uint32_t viewers = 0;
    std::uint32_t tile_readers = 0;
    double tile_rate = 0.0;
    std::string faults; ///< as they were given
};

/// All that a run tells.
struct RunReport {
    RunSettings settings;
    double seconds = 0.0; ///< from when the first scan was meant to be sent until the last ack
    FleetFigures fleet;
    AudienceFigures audience;
    double watched_seconds = 0.0;     ///< for which the use of processors was watched: some more
    ProcessUse own;                   ///< within that time, as that of the server
    std::optional<ServerUsed> server; ///< absent: it did not say
    Evidence evidence;
    Verdict verdict;
};

/// 99 % of all scans were handed to their robots within this: then the generator kept its times, and what the latencies
/// hold beyond it is the server's and the network's.
inline constexpr Micros kOwnDelayFine = 10 * kMillisecond;

/// Lines for people; the verdict is the last.
[[nodiscard]] std::string to_text(const RunReport& report);

/// The same for programs: one JSON object. docs/load.md lists its fields.
[[nodiscard]] std::string to_json(const RunReport& report);

} // namespace scanloom::load

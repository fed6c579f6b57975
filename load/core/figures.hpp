#pragma once

#include "load/core/fault_schedule.hpp"
#include "load/core/latency_histogram.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace scanloom::load {

/// Counts of the scans and links of many robots. Those of several threads can be added.
struct FleetCounts {
    std::uint64_t scans_due = 0;    ///< should have been sent by now
    std::uint64_t scans_sent = 0;   ///< each counted once
    std::uint64_t scans_resent = 0; ///< sent again after a reconnect, because no acknowledgement had arrived
    std::uint64_t scans_acknowledged = 0;
    std::uint64_t scans_lost = 0; ///< acknowledged, and later unknown to the server
    std::uint64_t frames_out = 0;
    std::uint64_t bytes_out = 0;
    std::uint64_t bytes_in = 0;

    std::uint32_t linked = 0;   ///< robots currently welcomed
    std::uint32_t greeted = 0;  ///< robots that were ever welcomed
    std::uint32_t finished = 0; ///< robots whose scans are all acknowledged
    std::uint32_t failed = 0;   ///< robots that gave up
    std::uint64_t links = 0;    ///< welcomes: the first of each robot and those after a lost link
    std::array<std::uint64_t, kFaultKinds> faults{};
    Micros last_ack = 0;

    void add(const FleetCounts& other) noexcept;
};

/// Statistics of many robots. Those of several threads can be added.
struct FleetFigures : FleetCounts {
    // The first and the last two are empty if there is no schedule of intended times.
    LatencyHistogram from_intended;   ///< from the intended sending time until the acknowledgement was read
    LatencyHistogram from_sending;    ///< from the last write to the socket until the acknowledgement was read
    LatencyHistogram waiting_to_send; ///< from the intended sending time until the first write to the socket
    LatencyHistogram own_delay;       ///< from the intended sending time until this program handled the scan

    void add(const FleetFigures& other) noexcept;
};

/// Statistics of the viewers and tile readers during a run.
struct AudienceFigures {
    std::uint32_t watching = 0;        ///< viewers currently connected
    std::uint32_t viewers_let_in = 0;  ///< viewers that have ever watched
    std::uint32_t viewers_refused = 0; ///< viewers that never watched because the server refused them
    std::uint64_t events = 0;
    std::uint64_t event_bytes = 0;
    std::uint64_t viewer_ends = 0; ///< connections of watching viewers that ended other than by stop()

    std::uint64_t tile_requests = 0;
    std::uint64_t tiles_unchanged = 0; ///< answered 304
    std::uint64_t tiles_failed = 0;    ///< not answered with 200 or 304, or not at all
    std::uint64_t tile_bytes = 0;
    LatencyHistogram tile_latency; ///< from the intended time of a request until the tile had arrived

    std::string trouble; ///< the most recent one; empty: none
};

/// Resources that a process used, since its start or between two moments.
struct ProcessUse {
    double cpu_seconds = 0.0;
    double resident_bytes = 0.0; ///< at the end
};

/// What the server's process reports about itself at one moment.
struct ServerUse {
    ProcessUse so_far;
    double started = 0.0; ///< seconds since the epoch; identifies the process, as a restarted one has another value
};

/// Resources that the server used between two moments.
struct ServerUsed {
    std::optional<double> cpu_seconds; ///< absent: it was restarted meanwhile, so the value is unknown
    double resident_bytes = 0.0;       ///< at the end
};

/// Absent if the server did not report at both moments.
[[nodiscard]] std::optional<ServerUsed> used_between(const std::optional<ServerUse>& before,
                                                     const std::optional<ServerUse>& after);

} // namespace scanloom::load

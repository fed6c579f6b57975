#pragma once

#include "load/core/fault_schedule.hpp"
#include "load/core/latency_histogram.hpp"

#include <array>
#include <cstdint>

namespace scanloom::load {

/// What became of the scans of many robots. Those of several threads add up.
struct FleetFigures {
    std::uint64_t scans_due = 0;    ///< that should have been sent by now
    std::uint64_t scans_sent = 0;   ///< each counted once
    std::uint64_t scans_resent = 0; ///< again after a reconnect, as nothing told that they had arrived
    std::uint64_t scans_acknowledged = 0;
    std::uint64_t scans_lost = 0; ///< acknowledged, and unknown to the server afterwards
    std::uint64_t frames_out = 0;
    std::uint64_t bytes_out = 0;
    std::uint64_t bytes_in = 0;

    std::uint32_t linked = 0;   ///< robots that are welcome at present
    std::uint32_t greeted = 0;  ///< that have ever been
    std::uint32_t finished = 0; ///< all of whose scans are acknowledged
    std::uint32_t failed = 0;   ///< that gave up
    std::uint64_t links = 0;    ///< welcomes: the first of each robot and those after its link was lost
    std::array<std::uint64_t, kFaultKinds> faults{};
    Micros last_ack = 0;

    // The first and the last two are empty where nothing tells when a scan is meant to be sent.
    LatencyHistogram from_intended;   ///< from when a scan was meant to be sent until its ack was read
    LatencyHistogram from_sending;    ///< from when it was handed to its socket (the last time) until then
    LatencyHistogram waiting_to_send; ///< from when it was meant to be sent until it was (the first time)
    LatencyHistogram own_delay;       ///< from when it was meant to be sent until this program came to it

    void add(const FleetFigures& other) noexcept;
};

} // namespace scanloom::load

#pragma once

#include "load/core/fault_schedule.hpp"
#include "load/core/latency_histogram.hpp"

#include <array>
#include <cstdint>

namespace scanloom::load {

/// Statistics of the scans of many robots. Those of several threads can be added.
struct FleetFigures {
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

    // The first and the last two are empty if there is no schedule of intended times.
    LatencyHistogram from_intended;   ///< from the intended sending time until the acknowledgement was read
    LatencyHistogram from_sending;    ///< from the last write to the socket until the acknowledgement was read
    LatencyHistogram waiting_to_send; ///< from the intended sending time until the first write to the socket
    LatencyHistogram own_delay;       ///< from the intended sending time until this program handled the scan

    void add(const FleetFigures& other) noexcept;
};

} // namespace scanloom::load

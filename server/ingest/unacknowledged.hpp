#pragma once

#include "server/metrics/metrics.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace scanloom::ingest {

/// Measures the scans of one link that were read and are not acknowledged yet: their number, and how long each waits
/// for its ack. A batch counts as acknowledged when its last scan is.
///
/// Queue: one entry per batch; bounded by the link's credit.
/// Threads: one at a time.
class Unacknowledged {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit Unacknowledged(metrics::IngestCounters& counters) : counters_(counters) {}
    Unacknowledged(const Unacknowledged&) = delete;
    Unacknowledged& operator=(const Unacknowledged&) = delete;

    /// Subtracts the remaining scans from the counters. They are not acknowledged, because the link has ended.
    ~Unacknowledged();

    /// Adds a batch.
    /// @param last_seq  sequence number of its last scan
    /// @param scans     number of its scans
    /// @param read      when its last byte was read from the link
    void add(std::uint64_t last_seq, std::size_t scans, Time read);

    /// Records that an ack of all scans up to durable_seq was passed to the socket.
    void acknowledge(std::uint64_t durable_seq, Time now);

private:
    struct Batch {
        std::uint64_t last_seq;
        std::size_t scans;
        Time read;
    };

    void take_off(const Batch& batch);

    metrics::IngestCounters& counters_;
    std::deque<Batch> batches_;
};

} // namespace scanloom::ingest

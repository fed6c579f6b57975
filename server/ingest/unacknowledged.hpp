#pragma once

#include "server/metrics/metrics.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace scanloom::ingest {

/// The scans of one link that were read and are not acknowledged yet: how many the server has of them, and how long
/// each waited. A batch counts as acknowledged when the last of its scans is.
/// Queue   one entry a batch; bounded by the link's credit.
/// Thread  one at a time.
class Unacknowledged {
public:
    using Time = std::chrono::steady_clock::time_point;

    explicit Unacknowledged(metrics::IngestCounters& counters) : counters_(counters) {}
    Unacknowledged(const Unacknowledged&) = delete;
    Unacknowledged& operator=(const Unacknowledged&) = delete;

    /// What is left will not be acknowledged: the link has ended.
    ~Unacknowledged();

    /// A batch whose last byte was read off the link at `read`.
    void add(std::uint64_t last_seq, std::size_t scans, Time read);

    /// An ack of all up to durable_seq was handed to the socket.
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

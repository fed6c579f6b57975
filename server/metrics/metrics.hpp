#pragma once

#include "common/error/error.hpp"
#include "server/access/refusal.hpp"
#include "server/metrics/duration_histogram.hpp"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/registry.h>

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace scanloom::metrics {

/// What the robots' links count. Thread: any.
class IngestCounters {
public:
    explicit IngestCounters(prometheus::Registry& registry);

    prometheus::Gauge& links_open;
    prometheus::Counter& scans_received;    ///< well-formed scans that arrived, within the credit
    prometheus::Counter& held_back_seconds; ///< in which links were not read, by the limits of their tokens
    prometheus::Gauge& scans_in_flight;     ///< read and not acknowledged yet
    DurationHistogram ack_seconds;          ///< of each scan: from being read to its ack being handed to the socket

    /// Links that ended without a goodbye, by the reason. Pre: one of the enumerators of Errc.
    [[nodiscard]] prometheus::Counter& failed(Errc reason) const { return *failed_[static_cast<std::size_t>(reason)]; }

private:
    std::vector<prometheus::Counter*> failed_; // by Errc
};

/// What is counted of viewers that watch sessions live. Thread: any.
class LiveCounters {
public:
    explicit LiveCounters(prometheus::Registry& registry);

    prometheus::Gauge& viewers;
    prometheus::Counter& refused; ///< because too many watched
    prometheus::Counter& events;  ///< sent
    prometheus::Counter& bytes;   ///< of those, without the frames of the WebSocket
};

/// What the HTTP server counts. Thread: any.
class HttpCounters {
public:
    explicit HttpCounters(prometheus::Registry& registry);

    prometheus::Gauge& connections_open;
    prometheus::Counter& connections_refused; ///< because too many were open
    DurationHistogram request_seconds;        ///< from the whole request to the start of its answer
    LiveCounters live;

    /// Answers by class of status. Pre: 100 <= status < 600.
    [[nodiscard]] prometheus::Counter& answered(unsigned status) const { return *by_class_[status / 100 - 1]; }

private:
    std::array<prometheus::Counter*, 5> by_class_;
};

/// Who was not let in, on both ports. Thread: any.
class RefusalCounters {
public:
    explicit RefusalCounters(prometheus::Registry& registry);

    [[nodiscard]] prometheus::Counter& of(access::Port port, access::Reason reason) const {
        return *counters_[static_cast<std::size_t>(port)][static_cast<std::size_t>(reason)];
    }

private:
    std::array<std::array<prometheus::Counter*, access::kReasons.size()>, access::kPorts.size()> counters_{};
};

/// Owns every counter of the process. Labels are fixed lists, never names that users choose.
class Metrics {
public:
    explicit Metrics(std::string_view version);

    [[nodiscard]] IngestCounters& ingest() noexcept { return ingest_; }
    [[nodiscard]] HttpCounters& http() noexcept { return http_; }
    [[nodiscard]] RefusalCounters& refusals() noexcept { return refusals_; }

    [[nodiscard]] std::vector<prometheus::MetricFamily> collect() const;

private:
    prometheus::Registry registry_;
    IngestCounters ingest_{registry_};
    HttpCounters http_{registry_};
    RefusalCounters refusals_{registry_};
};

} // namespace scanloom::metrics

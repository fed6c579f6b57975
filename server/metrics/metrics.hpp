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

/// Counters of the robot links.
/// Threads: any thread.
class IngestCounters {
public:
    explicit IngestCounters(prometheus::Registry& registry);

    prometheus::Gauge& links_open;
    prometheus::Counter& scans_received;    ///< well-formed scans that arrived, within the credit
    prometheus::Counter& held_back_seconds; ///< time in which links were not read because of their tokens' rate limits
    prometheus::Gauge& scans_in_flight;     ///< read and not acknowledged yet
    DurationHistogram ack_seconds;          ///< of each scan: from being read to passing its ack to the socket

    /// Returns the counter of links that ended without a goodbye for `reason`.
    /// Pre: `reason` is one of the enumerators of Errc.
    [[nodiscard]] prometheus::Counter& failed(Errc reason) const { return *failed_[static_cast<std::size_t>(reason)]; }

private:
    std::vector<prometheus::Counter*> failed_; // by Errc
};

/// Counters of the viewers that watch sessions live.
/// Threads: any thread.
class LiveCounters {
public:
    explicit LiveCounters(prometheus::Registry& registry);

    prometheus::Gauge& viewers;
    prometheus::Counter& refused; ///< because too many viewers were connected
    prometheus::Counter& events;  ///< sent
    prometheus::Counter& bytes;   ///< of those events, without WebSocket framing
};

/// Counters of the HTTP server.
/// Threads: any thread.
class HttpCounters {
public:
    explicit HttpCounters(prometheus::Registry& registry);

    prometheus::Gauge& connections_open;
    prometheus::Counter& connections_refused; ///< because too many were open
    DurationHistogram request_seconds;        ///< from the end of the request to the start of the response
    LiveCounters live;

    /// Returns the counter of responses in the status class of `status`. Pre: 100 <= status < 600.
    [[nodiscard]] prometheus::Counter& answered(unsigned status) const { return *by_class_[status / 100 - 1]; }

private:
    std::array<prometheus::Counter*, 5> by_class_;
};

/// Counters of refused connections and requests on both ports.
/// Threads: any thread.
class RefusalCounters {
public:
    explicit RefusalCounters(prometheus::Registry& registry);

    [[nodiscard]] prometheus::Counter& of(access::Port port, access::Reason reason) const {
        return *counters_[static_cast<std::size_t>(port)][static_cast<std::size_t>(reason)];
    }

private:
    std::array<std::array<prometheus::Counter*, access::kReasons.size()>, access::kPorts.size()> counters_{};
};

/// Owns every counter of the process. Label values come from fixed lists; names chosen by users are never labels.
class Metrics {
public:
    explicit Metrics(std::string_view version);

    [[nodiscard]] IngestCounters& ingest() noexcept { return ingest_; }
    [[nodiscard]] HttpCounters& http() noexcept { return http_; }
    [[nodiscard]] RefusalCounters& refusals() noexcept { return refusals_; }

    /// Returns the current values of all families.
    [[nodiscard]] std::vector<prometheus::MetricFamily> collect() const;

private:
    prometheus::Registry registry_;
    IngestCounters ingest_{registry_};
    HttpCounters http_{registry_};
    RefusalCounters refusals_{registry_};
};

} // namespace scanloom::metrics

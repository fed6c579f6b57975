#pragma once

#include "common/error/error.hpp"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/metric_family.h>
#include <prometheus/registry.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanloom::metrics {

/// Returns a family of one metric whose value is read at the time of the scrape instead of being counted.
template <class Number>
[[nodiscard]] prometheus::MetricFamily gauge_now(std::string name, std::string help, Number value) {
    prometheus::ClientMetric metric;
    metric.gauge.value = static_cast<double>(value);
    return {std::move(name), std::move(help), prometheus::MetricType::Gauge, {metric}};
}

template <class Number>
[[nodiscard]] prometheus::MetricFamily counter_now(std::string name, std::string help, Number value) {
    prometheus::ClientMetric metric;
    metric.counter.value = static_cast<double>(value);
    return {std::move(name), std::move(help), prometheus::MetricType::Counter, {metric}};
}

/// Returns the families in the Prometheus text format 0.0.4.
[[nodiscard]] std::string to_text(const std::vector<prometheus::MetricFamily>& families);

/// Counts durations in a Prometheus histogram in seconds, with buckets from 0.5 ms to 10 s.
/// Cost: observe() does a search among 14 bounds and two atomic additions; no lock.
/// Threads: any thread.
class DurationHistogram {
public:
    /// @param name  of the metric; ends in _seconds
    DurationHistogram(std::string name, std::string help) : name_(std::move(name)), help_(std::move(help)) {}

    /// Records `times` observations, each with the duration `took`.
    void observe(std::chrono::nanoseconds took, std::uint64_t times = 1) noexcept;

    /// Returns the current values. The counts are consistent with one another; the sum may lack observations that are
    /// being recorded.
    [[nodiscard]] prometheus::MetricFamily family() const;

private:
    /// Inclusive upper bounds, in microseconds. A cached tile takes a fraction of a millisecond, a whole map seconds.
    static constexpr std::array<std::uint32_t, 14> kBounds = {500,       1'000,     2'500,     5'000,     10'000,
                                                              25'000,    50'000,    100'000,   250'000,   500'000,
                                                              1'000'000, 2'500'000, 5'000'000, 10'000'000};

    std::string name_;
    std::string help_;
    std::array<std::atomic<std::uint64_t>, kBounds.size() + 1> counts_{}; // by bucket; the last has no upper bound
    std::atomic<std::uint64_t> nanoseconds_ = 0;                          // overflows after 584 years
};

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

/// Owns every counter of the process. Label values come from fixed lists; names chosen by users are never labels.
class Metrics {
public:
    explicit Metrics(std::string_view version);

    [[nodiscard]] IngestCounters& ingest() noexcept { return ingest_; }
    [[nodiscard]] HttpCounters& http() noexcept { return http_; }

    /// Returns the registry, in which other folders register families of their own.
    [[nodiscard]] prometheus::Registry& registry() noexcept { return registry_; }

    /// Returns the current values of all families.
    [[nodiscard]] std::vector<prometheus::MetricFamily> collect() const;

private:
    prometheus::Registry registry_;
    IngestCounters ingest_{registry_};
    HttpCounters http_{registry_};
};

} // namespace scanloom::metrics

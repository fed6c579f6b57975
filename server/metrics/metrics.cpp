#include "server/metrics/metrics.hpp"

#include <prometheus/text_serializer.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace scanloom::metrics {

std::string to_text(const std::vector<prometheus::MetricFamily>& families) {
    return prometheus::TextSerializer().Serialize(families);
}

void DurationHistogram::observe(std::chrono::nanoseconds took, std::uint64_t times) noexcept {
    const auto bound = std::ranges::lower_bound(
        kBounds, took, {}, [](std::uint32_t microseconds) { return std::chrono::microseconds(microseconds); });
    counts_[static_cast<std::size_t>(bound - kBounds.begin())].fetch_add(times, std::memory_order_relaxed);
    const auto positive = static_cast<std::uint64_t>(std::max(took, std::chrono::nanoseconds::zero()).count());
    nanoseconds_.fetch_add(positive * times, std::memory_order_relaxed);
}

prometheus::MetricFamily DurationHistogram::family() const {
    prometheus::ClientMetric metric;
    auto& histogram = metric.histogram;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
        histogram.sample_count += counts_[i].load(std::memory_order_relaxed);
        const bool has_bound = i < kBounds.size();
        histogram.bucket.push_back(
            {histogram.sample_count, has_bound ? kBounds[i] / 1e6 : std::numeric_limits<double>::infinity()});
    }
    histogram.sample_sum = static_cast<double>(nanoseconds_.load(std::memory_order_relaxed)) / 1e9;
    return {name_, help_, prometheus::MetricType::Histogram, {metric}};
}

namespace {

prometheus::Counter& counter(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Gauge& gauge(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

} // namespace

IngestCounters::IngestCounters(prometheus::Registry& registry)
    : links_open(gauge(registry, "scanloom_links_open", "Open connections of robots.")),
      scans_received(counter(registry, "scanloom_scans_received_total",
                             "Well-formed scans that robots sent, within their credit.")),
      held_back_seconds(
          counter(registry, "scanloom_links_held_back_seconds_total",
                  "Seconds in which robot connections were not read because of their tokens' rate limits.")),
      scans_in_flight(
          gauge(registry, "scanloom_scans_in_flight", "Scans that were read and are not acknowledged yet.")),
      ack_seconds("scanloom_ack_seconds", "Time from reading a scan to passing its acknowledgement to the socket.") {
    auto& family = prometheus::BuildCounter()
                       .Name("scanloom_links_failed_total")
                       .Help("Robot connections that ended without a goodbye, by reason.")
                       .Register(registry);
    for (int code = 0; name_of(static_cast<Errc>(code)) != "unknown"; ++code) {
        failed_.push_back(&family.Add({{"reason", std::string(name_of(static_cast<Errc>(code)))}}));
    }
}

LiveCounters::LiveCounters(prometheus::Registry& registry)
    : viewers(gauge(registry, "scanloom_live_viewers", "Viewers that watch a session over a WebSocket.")),
      refused(
          counter(registry, "scanloom_live_viewers_refused_total", "Viewers refused because too many were connected.")),
      events(counter(registry, "scanloom_live_events_total", "Events sent to viewers.")),
      bytes(counter(registry, "scanloom_live_bytes_total", "Bytes of the events sent to viewers.")) {}

HttpCounters::HttpCounters(prometheus::Registry& registry)
    : connections_open(gauge(registry, "scanloom_http_connections_open", "HTTP connections that are open.")),
      connections_refused(counter(registry, "scanloom_http_connections_refused_total",
                                  "HTTP connections refused because too many were open.")),
      request_seconds("scanloom_http_request_seconds", "Time from the end of a request to the start of its response."),
      live(registry) {
    auto& family = prometheus::BuildCounter()
                       .Name("scanloom_http_requests_total")
                       .Help("HTTP requests answered, by class of status.")
                       .Register(registry);
    constexpr std::array kClasses = {"1xx", "2xx", "3xx", "4xx", "5xx"};
    for (std::size_t i = 0; i < kClasses.size(); ++i) by_class_[i] = &family.Add({{"code", kClasses[i]}});
}

Metrics::Metrics(std::string_view version) {
    prometheus::BuildGauge()
        .Name("scanloom_build_info")
        .Help("Always 1; the version is in the label.")
        .Register(registry_)
        .Add({{"version", std::string(version)}})
        .Set(1.0);
}

std::vector<prometheus::MetricFamily> Metrics::collect() const {
    auto families = registry_.Collect();
    families.push_back(ingest_.ack_seconds.family());
    families.push_back(http_.request_seconds.family());
    return families;
}

} // namespace scanloom::metrics

#include "server/metrics/metrics.hpp"

#include <string>

namespace scanloom::metrics {
namespace {

prometheus::Counter& counter(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildCounter().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Gauge& gauge(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

/// Seconds: a cached tile takes a fraction of a millisecond, a whole map seconds.
const prometheus::Histogram::BucketBoundaries kSecondsBuckets = {0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                                                 0.1,    0.25,  0.5,    1.0,   2.5,  5.0,   10.0};

} // namespace

IngestCounters::IngestCounters(prometheus::Registry& registry)
    : links_open(gauge(registry, "scanloom_links_open", "Links of robots that are open.")),
      scans_received(counter(registry, "scanloom_scans_received_total", "Well-formed scans that robots sent.")) {
    auto& family = prometheus::BuildCounter()
                       .Name("scanloom_links_failed_total")
                       .Help("Links that ended without a goodbye, by reason.")
                       .Register(registry);
    for (int code = 0; name_of(static_cast<Errc>(code)) != "unknown"; ++code) {
        failed_.push_back(&family.Add({{"reason", std::string(name_of(static_cast<Errc>(code)))}}));
    }
}

LiveCounters::LiveCounters(prometheus::Registry& registry)
    : viewers(gauge(registry, "scanloom_live_viewers", "Viewers that watch a session over a WebSocket.")),
      refused(counter(registry, "scanloom_live_viewers_refused_total", "Viewers refused because too many watched.")),
      events(counter(registry, "scanloom_live_events_total", "Events sent to viewers.")),
      bytes(counter(registry, "scanloom_live_bytes_total", "Bytes of the events sent to viewers.")) {}

HttpCounters::HttpCounters(prometheus::Registry& registry)
    : connections_open(gauge(registry, "scanloom_http_connections_open", "HTTP connections that are open.")),
      connections_refused(counter(registry, "scanloom_http_connections_refused_total",
                                  "HTTP connections refused because too many were open.")),
      request_seconds(prometheus::BuildHistogram()
                          .Name("scanloom_http_request_seconds")
                          .Help("Time from a whole request to the start of its answer.")
                          .Register(registry)
                          .Add({}, kSecondsBuckets)),
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

} // namespace scanloom::metrics

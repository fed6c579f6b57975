#include "server/metrics/families.hpp"
#include "server/metrics/metrics.hpp"
#include "server/metrics/process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace scanloom::metrics {
namespace {

using testing::HasSubstr;

TEST(Metrics, BuildInfoNamesTheVersion) {
    const Metrics metrics("1.2.3");
    EXPECT_THAT(to_text(metrics.collect()), HasSubstr("scanloom_build_info{version=\"1.2.3\"} 1"));
}

TEST(Metrics, CountersStartAtZeroSoThatRatesCanBeTaken) {
    const Metrics metrics("1");
    const auto text = to_text(metrics.collect());
    for (const auto* line :
         {"scanloom_scans_received_total 0\n", "scanloom_links_failed_total{reason=\"out_of_order\"} 0\n",
          "scanloom_links_open 0\n", "scanloom_http_requests_total{code=\"5xx\"} 0\n",
          "scanloom_http_request_seconds_count 0\n"}) {
        EXPECT_THAT(text, HasSubstr(line));
    }
}

TEST(Metrics, WhatIsCountedIsShown) {
    Metrics metrics("1");
    metrics.ingest().scans_received.Increment(3);
    metrics.ingest().failed(Errc::kMalformed).Increment();
    metrics.ingest().failed(Errc::kUnreachable).Increment(2);
    metrics.http().answered(304).Increment();
    const auto text = to_text(metrics.collect());
    EXPECT_THAT(text, HasSubstr("scanloom_scans_received_total 3\n"));
    EXPECT_THAT(text, HasSubstr("scanloom_links_failed_total{reason=\"malformed\"} 1\n"));
    EXPECT_THAT(text, HasSubstr("scanloom_links_failed_total{reason=\"unreachable\"} 2\n"));
    EXPECT_THAT(text, HasSubstr("scanloom_http_requests_total{code=\"3xx\"} 1\n"));
}

TEST(Process, SaysWhatTheSystemKnowsOfIt) {
    std::map<std::string, double> values;
    for (const auto& family : process_families()) {
        const auto& metric = family.metric.front();
        values[family.name] =
            family.type == prometheus::MetricType::Counter ? metric.counter.value : metric.gauge.value;
    }
    EXPECT_GT(values.at("process_resident_memory_bytes"), 100'000.0);
    EXPECT_GT(values.at("process_virtual_memory_bytes"), values.at("process_resident_memory_bytes"));
    EXPECT_GE(values.at("process_open_fds"), 3.0);
    EXPECT_GT(values.at("process_max_fds"), values.at("process_open_fds"));
    EXPECT_GT(values.at("process_start_time_seconds"), 1.6e9);
    EXPECT_TRUE(values.contains("process_cpu_seconds_total"));
}

} // namespace
} // namespace scanloom::metrics

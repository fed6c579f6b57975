#include "server/metrics/metrics.hpp"
#include "server/metrics/process.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <fstream>
#include <map>
#include <thread>
#include <vector>

namespace scanloom::metrics {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::HasSubstr;

std::string text_of(const DurationHistogram& histogram) { return to_text({histogram.family()}); }

TEST(DurationHistogram, CountsDurationsUpToEachBound) {
    DurationHistogram histogram("wait_seconds", "Waits.");
    histogram.observe(microseconds(500)); // a bound belongs to its bucket
    histogram.observe(microseconds(501));
    histogram.observe(milliseconds(80), 3);
    histogram.observe(std::chrono::seconds(11));
    EXPECT_EQ(text_of(histogram), "# HELP wait_seconds Waits.\n"
                                  "# TYPE wait_seconds histogram\n"
                                  "wait_seconds_count 6\n"
                                  "wait_seconds_sum 11.241001\n"
                                  "wait_seconds_bucket{le=\"0.0005\"} 1\n"
                                  "wait_seconds_bucket{le=\"0.001\"} 2\n"
                                  "wait_seconds_bucket{le=\"0.0025\"} 2\n"
                                  "wait_seconds_bucket{le=\"0.005\"} 2\n"
                                  "wait_seconds_bucket{le=\"0.01\"} 2\n"
                                  "wait_seconds_bucket{le=\"0.025\"} 2\n"
                                  "wait_seconds_bucket{le=\"0.05\"} 2\n"
                                  "wait_seconds_bucket{le=\"0.1\"} 5\n"
                                  "wait_seconds_bucket{le=\"0.25\"} 5\n"
                                  "wait_seconds_bucket{le=\"0.5\"} 5\n"
                                  "wait_seconds_bucket{le=\"1\"} 5\n"
                                  "wait_seconds_bucket{le=\"2.5\"} 5\n"
                                  "wait_seconds_bucket{le=\"5\"} 5\n"
                                  "wait_seconds_bucket{le=\"10\"} 5\n"
                                  "wait_seconds_bucket{le=\"+Inf\"} 6\n");
}

TEST(DurationHistogram, CountsZeroInTheFirstBucket) {
    DurationHistogram histogram("wait_seconds", "Waits.");
    histogram.observe(milliseconds(-5));
    EXPECT_THAT(text_of(histogram), HasSubstr("wait_seconds_bucket{le=\"0.0005\"} 1\n"));
    EXPECT_THAT(text_of(histogram), HasSubstr("wait_seconds_sum 0\n"));
}

TEST(DurationHistogram, CountsAllObservationsOfSeveralThreads) {
    DurationHistogram histogram("wait_seconds", "Waits.");
    std::vector<std::thread> threads;
    for (int n = 0; n < 4; ++n) {
        threads.emplace_back([&] {
            for (int i = 0; i < 10'000; ++i) histogram.observe(milliseconds(1));
        });
    }
    for (auto& thread : threads) thread.join();
    EXPECT_THAT(text_of(histogram), HasSubstr("wait_seconds_count 40000\nwait_seconds_sum 40\n"));
}

TEST(Metrics, BuildInfoNamesTheVersion) {
    const Metrics metrics("1.2.3");
    EXPECT_THAT(to_text(metrics.collect()), HasSubstr("scanloom_build_info{version=\"1.2.3\"} 1"));
}

TEST(Metrics, CountersStartAtZero) {
    const Metrics metrics("1");
    const auto text = to_text(metrics.collect());
    for (const auto* line :
         {"scanloom_scans_received_total 0\n", "scanloom_links_failed_total{reason=\"out_of_order\"} 0\n",
          "scanloom_links_open 0\n", "scanloom_ack_seconds_count 0\n", "scanloom_scans_in_flight 0\n",
          "scanloom_http_requests_total{code=\"5xx\"} 0\n", "scanloom_http_request_seconds_count 0\n"}) {
        EXPECT_THAT(text, HasSubstr(line));
    }
}

TEST(Metrics, ShowsCountedValues) {
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

std::map<std::string, double> values_of(const std::vector<prometheus::MetricFamily>& families) {
    std::map<std::string, double> values;
    for (const auto& family : families) {
        const auto& metric = family.metric.front();
        values[family.name] =
            family.type == prometheus::MetricType::Counter ? metric.counter.value : metric.gauge.value;
    }
    return values;
}

TEST(Process, ReportsItsOwnUse) {
    const auto values = values_of(process_families());
    EXPECT_GT(values.at("process_resident_memory_bytes"), 100'000.0);
    EXPECT_GT(values.at("process_virtual_memory_bytes"), values.at("process_resident_memory_bytes"));
    EXPECT_GE(values.at("process_open_fds"), 3.0);
    EXPECT_GT(values.at("process_max_fds"), values.at("process_open_fds"));
    EXPECT_GT(values.at("process_start_time_seconds"), 1.6e9);
    EXPECT_TRUE(values.contains("process_cpu_seconds_total"));
}

TEST(Process, OmitsValuesThatCannotBeRead) {
    const TemporaryDirectory proc;
    const auto names = [&] {
        std::vector<std::string> found;
        for (const auto& [name, value] : values_of(process_families(proc.path()))) found.push_back(name);
        return found;
    };
    EXPECT_THAT(names(), testing::ElementsAre("process_max_fds"));
    std::filesystem::create_directory(proc.path() / "self");
    std::ofstream(proc.path() / "self/stat") << "7 (a) b) S 1 2 3\n"; // cut short
    EXPECT_THAT(names(), testing::ElementsAre("process_max_fds"));
}

TEST(Process, ReadsFieldsAfterAnyProgramName) {
    const TemporaryDirectory proc;
    std::filesystem::create_directory(proc.path() / "self");
    std::ofstream(proc.path() / "self/stat")
        << "7 (a) S 9) S 1 2 3 4 5 6 7 8 9 10 150 50 13 14 15 16 17 18 300 4096 2 0\n";
    std::ofstream(proc.path() / "stat") << "cpu 1 2 3\nbtime 1700000000\n";
    const auto values = values_of(process_families(proc.path()));
    const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
    EXPECT_DOUBLE_EQ(values.at("process_cpu_seconds_total"), 200.0 / ticks);
    EXPECT_DOUBLE_EQ(values.at("process_start_time_seconds"), 1.7e9 + 300.0 / ticks);
    EXPECT_DOUBLE_EQ(values.at("process_virtual_memory_bytes"), 4096.0);
    EXPECT_DOUBLE_EQ(values.at("process_resident_memory_bytes"), 2.0 * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

} // namespace
} // namespace scanloom::metrics

#include "robot_client/app/progress.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;

TEST(ProgressText, HasCountRateAndRemainingTime) {
    const UplinkStatus status{.resumed_after = 100, .last = 900, .acknowledged = 600, .is_linked = true};
    EXPECT_EQ(progress_text(status, 1100, 50.0), "600 of 1100 scans stored, 50 a second, 0:10 left");
    EXPECT_EQ(progress_text(status, std::nullopt, 50.0), "600 scans stored, 50 a second");
    EXPECT_EQ(progress_text(status, 500'000, 50.0), "600 of 500000 scans stored, 50 a second, 2:46:28 left");
}

TEST(ProgressText, ReportsAnUnreachableServer) {
    const UplinkStatus status{.last = 900, .acknowledged = 600};
    EXPECT_EQ(progress_text(status, std::nullopt, 60.0), "600 scans stored, 60 a second, not connected, 300 waiting");
}

TEST(ProgressText, ReportsSpoolLossesAndSourceRemarks) {
    UplinkStatus status{.last = 900, .acknowledged = 600, .waiting = 4000};
    EXPECT_EQ(progress_text(status, std::nullopt, 60.0), "600 scans stored, 60 a second, not connected, 4300 waiting");
    status.is_linked = true;
    status.dropped = 12;
    EXPECT_EQ(progress_text(status, std::nullopt, 60.0, "2 damaged packets"),
              "600 scans stored, 60 a second, 4300 waiting, 12 DROPPED for lack of space, 2 damaged packets");
}

TEST(RecentRate, CoversTheLastTenSeconds) {
    RecentRate rate;
    EXPECT_EQ(rate.update(0s, 100), 0.0);
    EXPECT_EQ(rate.update(2s, 200), 50.0);
    for (int second = 3; second <= 60; ++second) EXPECT_GE(rate.update(std::chrono::seconds(second), 200), 0.0);
    EXPECT_EQ(rate.update(61s, 200), 0.0) << "an outage";
    for (int second = 62; second <= 71; ++second) {
        EXPECT_NEAR(rate.update(std::chrono::seconds(second), 200U + 40U * static_cast<unsigned>(second - 61)),
                    40.0 * (second - 61) / 10.0, 1e-9);
    }
    EXPECT_EQ(rate.update(72s, 640), 40.0) << "older values are dropped";
    EXPECT_EQ(rate.update(100s, 1640), 1000.0 / 28.0) << "no value was added in between";
    EXPECT_EQ(rate.update(110s, 0), 0.0);
}

TEST(ProgressText, HasThePositionInALog) {
    EXPECT_EQ(reading_text("intel.log", {1'250'000, 20'000'000}), "intel.log: 1.2 of 20.0 MB read");
}

TEST(ProgressText, LongPauseShowsWhenTheNextScanIsDue) {
    const UplinkStatus status{.last = 3, .acknowledged = 3, .is_linked = true, .next_scan_in = 598.2s};
    EXPECT_EQ(progress_text(status, 5, 3.0), "3 of 5 scans stored, 3 a second, next scan in 9:59");
    EXPECT_EQ(pause_text(600s), "the next scan is due in 10:00; use --speed 0 to send without waiting");
}

} // namespace
} // namespace scanloom::robot

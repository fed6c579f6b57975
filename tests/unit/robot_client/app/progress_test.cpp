#include "robot_client/app/progress.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;

TEST(ProgressText, TellsCountRateAndRemainingTime) {
    UplinkStatus status{100, 900, 600, 0, 0, true};
    EXPECT_EQ(progress_text(status, 1100, 10s), "600 of 1100 scans stored, 50 a second, 0:10 left");
    EXPECT_EQ(progress_text(status, std::nullopt, 10s), "600 scans stored, 50 a second");
    EXPECT_EQ(progress_text(status, 500'000, 10s), "600 of 500000 scans stored, 50 a second, 2:46:28 left");
}

TEST(ProgressText, TellsThatTheServerIsAway) {
    UplinkStatus status{0, 900, 600, 0, 0, false};
    EXPECT_EQ(progress_text(status, std::nullopt, 10s), "600 scans stored, 60 a second, not connected, 300 waiting");
}

} // namespace
} // namespace scanloom::robot

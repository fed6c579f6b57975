#include "robot_client/sources/scan_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace scanloom::robot {
namespace {

using Stamps = std::vector<double>;
using Order = std::vector<std::uint32_t>;

TEST(ScanOrder, IncreasingStampsKeepTheFileOrder) {
    for (const Stamps& stamps : {Stamps{}, Stamps{5}, Stamps{1, 2, 2, 3}}) {
        const auto scans = order_of(stamps);
        EXPECT_EQ(scans.order.size(), stamps.size());
        EXPECT_TRUE(std::is_sorted(scans.order.begin(), scans.order.end()));
        EXPECT_TRUE(scans.file_order);
        EXPECT_TRUE(scans.is_of_stamps);
        EXPECT_EQ(scans.steps_back, 0U);
        EXPECT_EQ(scans.back_max, 0.0);
    }
}

TEST(ScanOrder, JitterIsMeasuredFromTheNewestStamp) {
    const auto jitter = order_of(Stamps{10, 9, 8, 11});
    EXPECT_EQ(jitter.order, (Order{0, 1, 2, 3}));
    EXPECT_TRUE(jitter.file_order);
    EXPECT_FALSE(jitter.is_of_stamps);
    EXPECT_EQ(jitter.steps_back, 2U);
    EXPECT_EQ(jitter.back_max, 2.0);
    const auto beyond = order_of(Stamps{10, 9, 7.9, 11});
    EXPECT_TRUE(beyond.is_clock_set_back) << "each step is within the jitter, but their sum is not";
    EXPECT_EQ(beyond.order, (Order{0, 1, 2, 3}));
    EXPECT_NEAR(beyond.back_max, 2.1, 1e-9);
}

TEST(ScanOrder, PartsAreSortedAndJitterWithinPartsIsKept) {
    // scans 100 to 103 were written before scans 50 to 52
    const auto scans = order_of(Stamps{100, 101, 100.5, 103, 50, 51, 50.5, 52});
    EXPECT_EQ(scans.order, (Order{4, 5, 6, 7, 0, 1, 2, 3}));
    EXPECT_FALSE(scans.file_order);
    EXPECT_FALSE(scans.is_clock_set_back);
    EXPECT_FALSE(scans.is_of_stamps);
    EXPECT_EQ(scans.steps_back, 3U);
    EXPECT_EQ(scans.back_max, 53.0);
}

TEST(ScanOrder, PartsThatOverlapByJitterAreSorted) {
    const auto scans = order_of(Stamps{100, 103, 102, 50, 51, 101.5});
    EXPECT_FALSE(scans.file_order);
    EXPECT_EQ(scans.order, (Order{3, 4, 5, 0, 1, 2}));
    EXPECT_TRUE(order_of(Stamps{100, 103, 102, 50, 51, 102.1}).is_clock_set_back);
}

/// Two places would be mixed if they were sorted by time.
TEST(ScanOrder, PartsAfterAClockWasSetBackKeepTheFileOrder) {
    for (const int back : {4, 400, 999}) {
        SCOPED_TRACE(back);
        Stamps stamps;
        for (int n = 0; n < 2000; ++n) stamps.push_back(n < 1000 ? n : n - back);
        const auto scans = order_of(stamps);
        EXPECT_TRUE(std::ranges::is_sorted(scans.order));
        EXPECT_EQ(scans.order.size(), stamps.size());
        EXPECT_TRUE(scans.file_order);
        EXPECT_TRUE(scans.is_clock_set_back);
        EXPECT_FALSE(scans.is_of_stamps);
        EXPECT_EQ(scans.steps_back, 1U);
        EXPECT_EQ(scans.back_max, back - 1);
    }
}

/// A part that follows two others must not overlap either.
TEST(ScanOrder, OnePartThatOverlapsKeepsTheFileOrder) {
    const Stamps sorted{200, 201, 100, 150, 160, 161};
    EXPECT_TRUE(order_of(sorted).file_order == false && order_of(sorted).order == (Order{2, 3, 4, 5, 0, 1}));
    EXPECT_TRUE(order_of(Stamps{200, 201, 100, 160, 120, 130}).is_clock_set_back);
    EXPECT_TRUE(order_of(Stamps{300, 301, 200, 260, 230, 250, 100, 110}).is_clock_set_back);
}

TEST(ScanOrder, AWrongStampLeavesItsScanInItsPlace) {
    for (const Stamps& stamps : {Stamps{1, 2, 1e9, 3, 2.5, 4}, Stamps{-1e308, 1e308, 1}, Stamps{50, 51, 1, 52, 53}}) {
        const auto scans = order_of(stamps);
        EXPECT_TRUE(std::ranges::is_sorted(scans.order));
        EXPECT_TRUE(scans.is_clock_set_back);
    }
}

} // namespace
} // namespace scanloom::robot

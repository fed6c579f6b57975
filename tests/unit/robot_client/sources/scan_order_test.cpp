#include "robot_client/sources/scan_order.hpp"

#include <gtest/gtest.h>

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
    EXPECT_FALSE(beyond.file_order) << "each step is within the jitter, but their sum is not";
    EXPECT_EQ(beyond.order, (Order{2, 0, 1, 3}));
}

TEST(ScanOrder, PartsAreSortedAndJitterWithinPartsIsKept) {
    // scans 100 to 103 were written before scans 50 to 52
    const auto scans = order_of(Stamps{100, 101, 100.5, 103, 50, 51, 50.5, 52});
    EXPECT_EQ(scans.order, (Order{4, 5, 6, 7, 0, 1, 2, 3}));
    EXPECT_FALSE(scans.file_order);
    EXPECT_FALSE(scans.is_of_stamps);
    EXPECT_EQ(scans.steps_back, 3U);
    EXPECT_EQ(scans.back_max, 53.0);
}

TEST(ScanOrder, OutlierStampMovesOnlyItsScan) {
    EXPECT_EQ(order_of(Stamps{1, 2, 1e9, 3, 2.5, 4}).order, (Order{0, 1, 3, 4, 5, 2}));
    EXPECT_EQ(order_of(Stamps{-1e308, 1e308, 1}).order, (Order{0, 2, 1}));
}

} // namespace
} // namespace scanloom::robot

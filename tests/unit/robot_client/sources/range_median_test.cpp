#include "robot_client/sources/stationary_detector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace scanloom::robot {
namespace {

using testing::Each;
using testing::ElementsAre;
using Ranges = std::vector<RangeMm>;

constexpr std::int32_t kTurn = 1000;

/// Filters beams that are evenly spaced over a part of a turn, so that the last and the first beam are not neighbours.
Ranges filtered_part(const Ranges& ranges, int window) {
    std::vector<std::int32_t> steps;
    for (std::size_t i = 0; i < ranges.size(); ++i) steps.push_back(static_cast<std::int32_t>(100 + 10 * i));
    return median_filtered(ranges, steps, 10 * kTurn, window);
}

TEST(MedianFiltered, KeepsTheSetOfReturns) {
    std::mt19937 random(3);
    for (int round = 0; round < 200; ++round) {
        Ranges ranges(20 + random() % 40);
        for (auto& range : ranges) {
            const auto kind = random() % 6;
            range = kind == 0 ? kInvalidRange : kind == 1 ? kNoReturn : static_cast<RangeMm>(100 + random() % 5000);
        }
        const Ranges filtered = filtered_part(ranges, 3 + 2 * static_cast<int>(random() % 5));
        for (std::size_t i = 0; i < ranges.size(); ++i) {
            for (const RangeMm mark : {kInvalidRange, kNoReturn}) EXPECT_EQ(filtered[i] == mark, ranges[i] == mark);
        }
    }
}

TEST(MedianFiltered, IsTheMedianOfAllNeighbours) {
    std::mt19937 random(5);
    Ranges ranges(99);
    for (auto& range : ranges) range = static_cast<RangeMm>(100 + random() % 5000);
    for (const int window : {3, 5, 11, 51}) {
        const Ranges filtered = filtered_part(ranges, window);
        for (int i = 0; i < 99; ++i) {
            const int reach = std::min({window / 2, i, 98 - i}); // equal numbers of neighbours on both sides
            Ranges around(ranges.begin() + i - reach, ranges.begin() + i + reach + 1);
            std::ranges::sort(around);
            EXPECT_EQ(filtered[static_cast<std::size_t>(i)], around[around.size() / 2]) << window << ", " << i;
        }
    }
}

TEST(MedianFiltered, WrapsAroundTheBeginOfATurn) {
    const Ranges ranges{900, 100, 100, 100, 100, 100, 100, 100, 100, 100};
    const std::vector<std::int32_t> steps{0, 100, 200, 300, 400, 500, 600, 700, 800, 900};
    EXPECT_THAT(median_filtered(ranges, steps, kTurn, 3), Each(100U));
}

TEST(MedianFiltered, DoesNotReachAcrossAGap) {
    Ranges ranges{100, 100, 100, 300, 700, 700, 700, 700, 700, 700};
    std::vector<std::int32_t> steps{0, 10, 20, 30, 71, 81, 91, 101, 111, 121};
    EXPECT_EQ(median_filtered(ranges, steps, kTurn, 5)[3], 300U) << "the beam is at the edge of a gap";
    for (std::size_t i = 4; i < steps.size(); ++i) steps[i] -= 1;
    EXPECT_EQ(median_filtered(ranges, steps, kTurn, 3)[3], 300U);
    ranges[3] = 900;
    EXPECT_EQ(median_filtered(ranges, steps, kTurn, 3)[3], 700U) << "four regular steps are not a gap";
}

TEST(MedianFiltered, FewerBeamsThanTheWindowStayUnchanged) {
    EXPECT_THAT(filtered_part({1, 9, 1}, 5), ElementsAre(1, 9, 1));
}

} // namespace
} // namespace scanloom::robot

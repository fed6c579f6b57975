#include "server/landmarks/median_filter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <set>

namespace scanloom::landmarks {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;
constexpr RangeMm kBad = kInvalidRange;
constexpr RangeMm kFar = kNoReturn;

std::vector<RangeMm> filtered(const std::vector<RangeMm>& ranges, std::size_t window, bool full_circle) {
    return median_filtered(ranges, window, full_circle).value();
}

/// The median of the returns at most half a window of beams away, each beam taken once.
std::vector<RangeMm> oracle(const std::vector<RangeMm>& ranges, int window, bool full_circle) {
    const int count = static_cast<int>(ranges.size());
    const auto at = [&](int beam) { return ranges[static_cast<std::size_t>(beam)]; };
    const auto is_return = [&](int beam) { return at(beam) != kBad && at(beam) != kFar; };
    std::vector<RangeMm> result = ranges;
    for (int beam = 0; beam < count; ++beam) {
        if (!is_return(beam)) continue;
        std::set<int> around;
        for (int n = beam - window / 2; n <= beam + window / 2; ++n) {
            if (full_circle) around.insert(((n % count) + count) % count);
            if (!full_circle && n >= 0 && n < count) around.insert(n);
        }
        std::vector<std::uint64_t> values;
        for (const int n : around) {
            if (is_return(n)) values.push_back(at(n));
        }
        std::ranges::sort(values);
        const std::size_t half = values.size() / 2;
        result[static_cast<std::size_t>(beam)] =
            static_cast<RangeMm>(values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2);
    }
    return result;
}

TEST(MedianFilter, IsTheMedianOfTheReturnsInTheWindow) {
    std::mt19937 random(1);
    for (int round = 0; round < 4000; ++round) {
        std::vector<RangeMm> ranges(random() % 130);
        for (RangeMm& range : ranges) {
            const auto kind = random() % 10;
            if (kind == 0) {
                range = kBad;
            } else if (kind == 1) {
                range = kFar;
            } else { // some as long as can be
                range = static_cast<RangeMm>(kind == 2 ? kFar - 1 - random() % 5 : 1 + random() % 3000);
            }
        }
        const int window = 1 + 2 * static_cast<int>(random() % (round % 2 == 0 ? 6 : 51));
        for (const bool full_circle : {false, true}) {
            ASSERT_EQ(filtered(ranges, static_cast<std::size_t>(window), full_circle),
                      oracle(ranges, window, full_circle))
                << ranges.size() << " beams, window " << window << (full_circle ? ", full circle" : "");
        }
    }
}

TEST(MedianFilter, TakesOutALoneSpike) {
    EXPECT_THAT(filtered({1000, 1000, 9000, 1000, 1000}, 3, false), ElementsAre(1000, 1000, 1000, 1000, 1000));
}

TEST(MedianFilter, KeepsAnEdge) {
    EXPECT_THAT(filtered({1000, 1000, 1000, 5000, 5000, 5000}, 3, false),
                ElementsAre(1000, 1000, 1000, 5000, 5000, 5000));
}

TEST(MedianFilter, GoesRoundAFullCircleAlone) {
    EXPECT_THAT(filtered({9000, 1000, 1000, 1000, 9000}, 3, true), ElementsAre(9000, 1000, 1000, 1000, 9000));
    EXPECT_THAT(filtered({9000, 1000, 1000, 1000, 1000}, 3, true), ElementsAre(1000, 1000, 1000, 1000, 1000));
    EXPECT_THAT(filtered({9000, 1000, 1000, 1000, 1000}, 3, false), ElementsAre(5000, 1000, 1000, 1000, 1000));
}

TEST(MedianFilter, WhatIsNoReturnNeitherCountsNorChanges) {
    EXPECT_THAT(filtered({1000, kBad, 1002, kFar, 1010}, 5, false), ElementsAre(1001, kBad, 1002, kFar, 1006));
    EXPECT_THAT(filtered({kBad, kFar, kBad}, 3, true), ElementsAre(kBad, kFar, kBad));
    EXPECT_THAT(filtered({kBad, 700, kFar}, 3, true), ElementsAre(kBad, 700, kFar));
}

TEST(MedianFilter, HalfMillimetresGoDown) {
    EXPECT_THAT(filtered({1000, 1003}, 3, false), ElementsAre(1001, 1001));
    EXPECT_THAT(filtered({0xFFFF'FFFE, 0xFFFF'FFFD}, 3, false), ElementsAre(0xFFFF'FFFD, 0xFFFF'FFFD));
}

TEST(MedianFilter, AWindowOfOneChangesNothing) {
    EXPECT_THAT(filtered({5, 1, 9}, 1, true), ElementsAre(5, 1, 9));
    EXPECT_THAT(filtered({}, 1, true), IsEmpty());
    EXPECT_THAT(filtered({}, 101, false), IsEmpty());
}

TEST(MedianFilter, WindowsThatAreEvenOrOutOfRangeAreRefused) {
    for (const std::size_t window : {0U, 2U, 100U, 102U, 103U, 1'000'001U}) {
        const auto refused = median_filtered(std::vector<RangeMm>{1, 2, 3}, window, false);
        ASSERT_FALSE(refused) << window;
        EXPECT_EQ(refused.error().code, Errc::kInvalidField);
        EXPECT_THAT(refused.error().message, HasSubstr("odd and 1 .. 101"));
    }
}

TEST(MedianFilter, SensorsThatTurnAllTheWayAreFullCircles) {
    EXPECT_TRUE(is_full_circle(UniformAngles{-kPi, 2 * kPi / 360, 360}));
    EXPECT_TRUE(is_full_circle(UniformAngles{kPi, -2 * kPi / 100, 100})); // clockwise
    EXPECT_TRUE(is_full_circle(UniformAngles{0.0, 2 * kPi / 90, 91}));    // the first direction repeated
    EXPECT_TRUE(is_full_circle(UniformAngles{0.3, 2 * kPi / 16, 16}));
    SteppedAngles turn{2 * kPi / 396'000, {}};
    for (std::int32_t step = 400; step < 396'000; step += 880) turn.steps.push_back(step);
    EXPECT_TRUE(is_full_circle(turn));
    turn.steps.pop_back();
    EXPECT_TRUE(is_full_circle(turn));
    turn.steps.resize(turn.steps.size() - 11); // a packet was lost
    EXPECT_FALSE(is_full_circle(turn));
}

TEST(MedianFilter, SensorsThatDoNotAreNone) {
    EXPECT_FALSE(is_full_circle(UniformAngles{-kPi / 2, kPi / 683, 684}));
    EXPECT_FALSE(is_full_circle(UniformAngles{-0.75 * kPi, 1.5 * kPi / 1080, 1081}));
    EXPECT_FALSE(is_full_circle(UniformAngles{0.0, kPi, 2}));
    EXPECT_FALSE(is_full_circle(UniformAngles{0.0, 1.0, 1}));
    EXPECT_FALSE(is_full_circle(ExplicitAngles{}));
    EXPECT_FALSE(is_full_circle(ExplicitAngles{0.5, 0.5, 0.5}));
}

} // namespace
} // namespace scanloom::landmarks

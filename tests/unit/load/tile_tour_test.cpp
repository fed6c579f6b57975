#include "load/core/tile_tour.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace scanloom::load {
namespace {

constexpr Micros kTourPeriod = 50 * kMillisecond;
constexpr Micros kFirst = 3 * kSecond;

TEST(TileTour, TilesUseTimeSlotsAndListsDoNot) {
    TileTour tour(20.0, kFirst);
    Micros turn = kFirst;
    for (int round = 0; round < 4; ++round) {
        const auto list = tour.next();
        EXPECT_TRUE(list.is_list);
        EXPECT_EQ(list.layer, round % 2 == 0 ? "occupancy" : "classification");
        EXPECT_EQ(list.at, turn) << "the list is requested right after the last tile";
        tour.listed({{1, 2}, {3, 4}, {5, 6}});
        for (const std::uint32_t x : {1U, 3U, 5U}) {
            const auto step = tour.next();
            EXPECT_FALSE(step.is_list);
            EXPECT_EQ(step.layer, list.layer);
            EXPECT_EQ(step.tile.x, x);
            EXPECT_EQ(step.tile.y, x + 1);
            EXPECT_EQ(step.at, turn += kTourPeriod);
        }
    }
}

TEST(TileTour, EmptyMapIsRequestedOncePerTimeSlot) {
    TileTour tour(20.0, kFirst);
    for (int n = 0; n < 5; ++n) {
        const auto list = tour.next();
        EXPECT_TRUE(list.is_list);
        EXPECT_EQ(list.at, kFirst + n * kTourPeriod);
        tour.listed({});
    }
}

} // namespace
} // namespace scanloom::load

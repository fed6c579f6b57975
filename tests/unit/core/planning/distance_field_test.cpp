#include "core/planning/distance_field.hpp"
#include "tests/support/class_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scanloom::planning {
namespace {

using namespace testing_support;

TEST(DistanceField, MatchesBruteForceDistanceToNearestOccupiedCell) {
    std::mt19937 random(51);
    for (int round = 0; round < 40; ++round) {
        const grid::CellBox box{-70 + random_below(random, 60), -50 + random_below(random, 40),
                                10 + random_below(random, 90), 10 + random_below(random, 40)};
        ClassMap map;
        std::vector<Cell> inside;
        for (int n = 0; n < (1 << (round % 10)); ++n) {
            const Cell cell{-80 + random_below(random, 200), -60 + random_below(random, 130)};
            map.set(cell, CellClass::kOccupied);
            map.set({cell.i + 1, cell.j}, CellClass::kDanger);
        }
        const auto view = map.view();
        for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
            for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
                if (class_at(view, {i, j}) == CellClass::kOccupied) inside.push_back({i, j});
            }
        }
        const auto field = distance_field(view, 0.05, box).value();
        ASSERT_EQ(field.window, box);
        for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
            for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
                double nearest = std::numeric_limits<double>::infinity();
                for (const Cell cell : inside) nearest = std::min(nearest, std::hypot(i - cell.i, j - cell.j));
                ASSERT_FLOAT_EQ(field.at({i, j}), static_cast<float>(nearest * 0.05)) << "cell " << i << ", " << j;
            }
        }
    }
}

TEST(DistanceField, IsInfiniteWithoutObstacles) {
    const auto field = distance_field(ClassView{}, 0.05, {-3, -3, 3, 3}).value();
    EXPECT_THAT(field.metres, testing::SizeIs(36));
    EXPECT_THAT(field.metres, testing::Each(std::numeric_limits<float>::infinity()));
    EXPECT_TRUE(distance_field(ClassView{}, 0.05, {})->metres.empty());
}

TEST(DistanceField, RefusesTooLargeWindow) {
    EXPECT_EQ(distance_field(ClassView{}, 0.05, {0, 0, 10'000, 10'000}).error().code, Errc::kTooLarge);
}

TEST(DistanceField, FarObstaclesDoNotChangeDistancesToNearOnes) {
    ClassMap map;
    map.set({0, 0}, CellClass::kOccupied);
    map.set({1, 1 << 17}, CellClass::kOccupied);
    const auto field = distance_field(map.view(), 1.0, {0, 0, 2, (1 << 17) + 1}).value();
    EXPECT_FLOAT_EQ(field.at({1, 0}), 1.0F);
    EXPECT_FLOAT_EQ(field.at({0, 1 << 17}), 1.0F);
}

TEST(DistanceField, LongRowIsExactAtItsEnd) {
    const auto field = distance_field(drawn({"#"}), 1.0, {0, 0, 3'000'000, 1}).value();
    EXPECT_FLOAT_EQ(field.at({2'999'999, 0}), 2'999'999.0F);
}

} // namespace
} // namespace scanloom::planning

#include "server/landmarks/distinct_points.hpp"
#include "tests/unit/server/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(DistinctPoints, KeepTheFirstOccurrencesInOrder) {
    std::mt19937 random(1);
    for (int round = 0; round < 1000; ++round) {
        const auto cloud = random_points(random, random() % 60);
        std::vector<Point2> points;
        std::vector<std::uint32_t> counts;
        std::vector<std::uint32_t> of;
        for (const Point2& point : cloud) {
            const auto at = static_cast<std::size_t>(std::ranges::find(points, point) - points.begin());
            if (at == points.size()) {
                points.push_back(point);
                counts.push_back(0);
            }
            ++counts[at];
            of.push_back(static_cast<std::uint32_t>(at));
        }
        const DistinctPoints distinct = distinct_points(cloud);
        ASSERT_EQ(distinct.points, points);
        ASSERT_EQ(distinct.counts, counts);
        ASSERT_EQ(distinct.of, of);
    }
}

TEST(DistinctPoints, TreatNegativeZeroAsZero) {
    const auto distinct = distinct_points(std::vector<Point2>{{0.0, 1.0}, {-0.0, 1.0}, {0.0, 2.0}, {-0.0, 1.0}});
    EXPECT_THAT(distinct.counts, ElementsAre(3, 1));
    EXPECT_THAT(distinct.of, ElementsAre(0, 0, 1, 0));
}

} // namespace
} // namespace scanloom::landmarks

#include "core/landmarks/points.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace scanloom::landmarks {
namespace {

using testing::HasSubstr;

TEST(PointCheck, AcceptsFinitePointsWithinTheLimit) {
    EXPECT_TRUE(check_points({}));
    EXPECT_TRUE(check_points(std::vector<Point2>{{0.0, -0.0}, {1e7, -1e7}, {1e-300, 5e-324}}));
}

TEST(PointCheck, RefusesTheFirstPointThatIsNotFinite) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
        for (const Point2& point : {Point2{bad, 0.0}, Point2{0.0, bad}}) {
            const auto checked = check_points(std::vector<Point2>{{1.0, 2.0}, point, point});
            ASSERT_FALSE(checked);
            EXPECT_EQ(checked.error().code, Errc::kInvalidField);
            EXPECT_THAT(checked.error().message, HasSubstr("points[1]"));
        }
    }
}

TEST(PointCheck, RefusesTheFirstPointThatIsTooFar) {
    const auto checked = check_points(std::vector<Point2>{{1.0, 2.0}, {0.0, -1.1e7}});
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, Errc::kInvalidField);
    EXPECT_THAT(checked.error().message, HasSubstr("points[1] is (0, -11000000)"));
}

} // namespace
namespace {

using namespace testing_support;
using testing::ElementsAre;

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

#include "core/landmarks/points.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Cloud, IsScaledThenRotatedThenTranslated) {
    const std::vector<Point2> points = {{1.0, 0.0}, {0.0, 2.0}};
    const auto moved = transform_points(points, {10.0, 20.0}, std::numbers::pi / 2.0, 3.0).value();
    ASSERT_EQ(moved.size(), 2U);
    EXPECT_LT(norm(moved[0] - Point2{10.0, 23.0}), 1e-12);
    EXPECT_LT(norm(moved[1] - Point2{4.0, 20.0}), 1e-12);
}

TEST(Cloud, IdentityTransformKeepsEveryBit) {
    std::mt19937 random(1);
    const auto points = random_points(random, 200);
    EXPECT_EQ(transform_points(points, {0.0, 0.0}, 0.0).value(), points);
    EXPECT_THAT(transform_points({}, {1.0, 2.0}, 3.0).value(), IsEmpty());
}

TEST(Cloud, KeepsScaledDistancesAndOrientation) {
    std::mt19937 random(2);
    for (int round = 0; round < 1000; ++round) {
        const auto points = random_points(random, 3);
        const double scale = uniform(random, 0.1, 5.0);
        const Point2 translation{uniform(random, -9.0, 9.0), uniform(random, -9.0, 9.0)};
        const auto moved = transform_points(points, translation, uniform(random, -9.0, 9.0), scale).value();
        const auto area = [](const std::vector<Point2>& p) {
            return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
        };
        ASSERT_NEAR(area(moved), scale * scale * area(points), 1e-9);
        ASSERT_NEAR(norm(moved[1] - moved[0]), scale * norm(points[1] - points[0]), 1e-9);
    }
}

TEST(Cloud, RefusesInvalidPointsAndTransforms) {
    const double nan = std::nan("");
    const double infinite = std::numeric_limits<double>::infinity();
    const std::vector<Point2> points = {{1.0, 1.0}};
    for (const double bad : {0.0, -1.0, nan, infinite}) {
        EXPECT_THAT(transform_points(points, {0.0, 0.0}, 0.0, bad).error().message, HasSubstr("scale")) << bad;
    }
    for (const double bad : {nan, infinite}) {
        EXPECT_THAT(transform_points(points, {bad, 0.0}, 0.0).error().message, HasSubstr("must be finite"));
        EXPECT_THAT(transform_points(points, {0.0, 0.0}, bad).error().message, HasSubstr("must be finite"));
        const std::vector<Point2> broken = {{1.0, 1.0}, {bad, 1.0}};
        EXPECT_THAT(transform_points(broken, {0.0, 0.0}, 0.0).error().message, HasSubstr("points[1]"));
    }
    EXPECT_THAT(transform_points(points, {0.0, 0.0}, 0.0, 2e7).error().message, HasSubstr("transformed[0]"));
    EXPECT_TRUE(check_points(std::vector<Point2>{{kPointCoordinateMax, -kPointCoordinateMax}}));
}

} // namespace
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

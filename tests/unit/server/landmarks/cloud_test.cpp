#include "server/landmarks/cloud.hpp"

#include "server/landmarks/point_check.hpp"
#include "tests/unit/server/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

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
} // namespace scanloom::landmarks

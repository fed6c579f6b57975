#include "common/geometry/point2.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace scanloom {
namespace {

TEST(Point2, OperatorsWorkOnBothCoordinates) {
    constexpr Point2 kA{1.0, -2.0};
    constexpr Point2 kB{0.5, 4.0};
    EXPECT_EQ(kA + kB, (Point2{1.5, 2.0}));
    EXPECT_EQ(kA - kB, (Point2{0.5, -6.0}));
    EXPECT_EQ(-kA, (Point2{-1.0, 2.0}));
    EXPECT_EQ(3.0 * kA, (Point2{3.0, -6.0}));
    EXPECT_EQ(kA * 3.0, 3.0 * kA);
    EXPECT_EQ(kA / 4.0, (Point2{0.25, -0.5}));
    Point2 sum = kA;
    sum += kB;
    EXPECT_EQ(sum, kA + kB);
    sum -= kB;
    EXPECT_EQ(sum, kA);
    sum *= 4.0;
    EXPECT_EQ(sum, kA * 4.0);
    sum /= 4.0;
    EXPECT_EQ(sum, kA);
    EXPECT_NE(kA, (Point2{1.0, 2.0}));
    EXPECT_NE(kA, (Point2{2.0, -2.0}));
}

TEST(Point2, ComputesNormsAndDotProduct) {
    EXPECT_EQ(dot({1.0, 2.0}, {3.0, -4.0}), -5.0);
    EXPECT_EQ(squared_norm({3.0, -4.0}), 25.0);
    EXPECT_EQ(norm({3.0, -4.0}), 5.0);
    EXPECT_EQ(max_abs({3.0, -4.0}), 4.0);
    EXPECT_EQ(max_abs({-5.0, 4.0}), 5.0);
}

TEST(Point2, NormalizedHasNormOneExceptForZero) {
    EXPECT_EQ(normalized({3.0, -4.0}), (Point2{0.6, -0.8}));
    EXPECT_EQ(normalized({0.0, 0.0}), (Point2{0.0, 0.0}));
    EXPECT_EQ(normalized({1e-200, 0.0}), (Point2{1e-200, 0.0})) << "its squared norm is rounded to 0";
}

TEST(Point2, CornersBoundBothPoints) {
    EXPECT_EQ(min_corner({1.0, 5.0}, {3.0, 2.0}), (Point2{1.0, 2.0}));
    EXPECT_EQ(max_corner({1.0, 5.0}, {3.0, 2.0}), (Point2{3.0, 5.0}));
}

TEST(Point2, IsFiniteNeedsTwoFiniteCoordinates) {
    EXPECT_TRUE(is_finite(Point2{1e300, -1e300}));
    EXPECT_FALSE(is_finite(Point2{std::numeric_limits<double>::quiet_NaN(), 0.0}));
    EXPECT_FALSE(is_finite(Point2{0.0, std::numeric_limits<double>::infinity()}));
}

} // namespace
} // namespace scanloom

#include "core/landmarks/landmark.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;

/// Computes the continuity of models.md, section 7, with the major axis found by trying directions. Pre: a major axis
/// exists.
Continuity continuity_oracle(const std::vector<Point2>& points, double eps) {
    const auto variance_along = [&](double angle, std::vector<double>& places) {
        places.clear();
        for (const Point2& point : points) places.push_back(point.x * std::cos(angle) + point.y * std::sin(angle));
        double mean = 0.0;
        for (const double place : places) mean += place;
        mean /= static_cast<double>(places.size());
        double variance = 0.0;
        for (const double place : places) variance += (place - mean) * (place - mean);
        return variance / static_cast<double>(places.size());
    };
    std::vector<double> places;
    double best = 0.0;
    for (double step = std::numbers::pi / 64; step > 1e-13; step /= 8) {
        const double middle = best;
        for (int n = -64; n <= 64; ++n) {
            if (variance_along(middle + n * step, places) > variance_along(best, places)) best = middle + n * step;
        }
    }
    const double minor = variance_along(best + std::numbers::pi / 2, places);
    const double major = variance_along(best, places);
    std::ranges::sort(places);
    double squares = 0.0;
    double filled = 0.0;
    const double extent = places.back() - places.front();
    const auto gaps = static_cast<double>(places.size() - 1);
    for (std::size_t n = 1; n < places.size(); ++n) {
        const double gap = places[n] - places[n - 1];
        squares += (gap - extent / gaps) * (gap - extent / gaps);
        if (gap < 2.0 * eps) filled += gap;
    }
    return {1.0 - minor / major, 1.0 / (1.0 + std::sqrt(squares / gaps) / (extent / gaps)), filled / extent};
}

TEST(Continuity, MatchesTheDefinition) {
    std::mt19937 random(1);
    for (int round = 0; round < 300; ++round) {
        std::vector<Point2> points;
        const double turn = uniform(random, 0.0, 7.0);
        const double width = uniform(random, 0.0, 1.5);
        for (std::size_t n = 0; n < 2 + random() % 40; ++n) {
            const double along = uniform(random, -1.0, 1.0) * (random() % 4 == 0 ? 2.0 : 1.0);
            const double across = uniform(random, -0.5, 0.5) * width;
            points.push_back({5.0 + along * std::cos(turn) - across * std::sin(turn),
                              3.0 + along * std::sin(turn) + across * std::cos(turn)});
        }
        const double eps = uniform(random, 0.02, 0.4);
        const auto expected = continuity_oracle(points, eps);
        if (expected.linearity < 0.01) continue; // the major axis is not defined
        const auto found = continuity_of(points, eps);
        EXPECT_NEAR(found.linearity, expected.linearity, 1e-6) << "round " << round;
        EXPECT_NEAR(found.evenness, expected.evenness, 1e-5) << "round " << round;
        EXPECT_NEAR(found.fill, expected.fill, 1e-5) << "round " << round;
    }
}

TEST(Continuity, EvenlySampledStraightWallHasContinuityOne) {
    for (const Point2& step : {Point2{0.1, 0.0}, Point2{0.0, 0.1}, Point2{0.1, 0.1}, Point2{-0.1, 0.05}}) {
        std::vector<Point2> wall;
        for (int n = 0; n < 30; ++n) wall.push_back(Point2{100.0, -200.0} + n * step);
        EXPECT_NEAR(continuity_of(wall, 0.1).mean(), 1.0, 1e-6);
    }
}

TEST(Continuity, GapsOfAtLeastTwoEpsAreNotFilled) {
    const std::vector<Point2> points = {{0.0, 0.0}, {0.25, 0.0}, {0.75, 0.0}, {1.0, 0.0}};
    EXPECT_DOUBLE_EQ(continuity_of(points, 0.25).fill, 0.5);
    EXPECT_DOUBLE_EQ(continuity_of(points, 0.26).fill, 1.0);
    EXPECT_DOUBLE_EQ(continuity_of(points, 0.1).fill, 0.0);
}

TEST(Continuity, SquareHasNoLinearity) {
    const std::vector<Point2> square = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
    EXPECT_EQ(continuity_of(square, 0.5).linearity, 0.0);
    // Along x, the gaps are 0, 1 and 0.
    EXPECT_NEAR(continuity_of(square, 0.6).evenness, 1.0 / (1.0 + std::sqrt(2.0)), 1e-12);
    EXPECT_EQ(continuity_of(square, 0.6).fill, 1.0);
}

TEST(Continuity, IsZeroWithoutExtent) {
    EXPECT_EQ(continuity_of({}, 0.1), Continuity{});
    EXPECT_EQ(continuity_of(std::vector<Point2>{{1.0, 2.0}}, 0.1), Continuity{});
    EXPECT_EQ(continuity_of(std::vector<Point2>(7, Point2{0.1, 0.7}), 0.1), Continuity{});
}

TEST(Continuity, TwoPointsHaveContinuityOne) {
    const auto found = continuity_of(std::vector<Point2>{{1.0, 2.0}, {1.3, 2.4}}, 0.3);
    EXPECT_NEAR(found.linearity, 1.0, 1e-12);
    EXPECT_EQ(found.evenness, 1.0);
    EXPECT_EQ(found.fill, 1.0);
}

TEST(Continuity, IsBetweenZeroAndOneForAnyPoints) {
    std::mt19937 random(2);
    for (int round = 0; round < 3000; ++round) {
        auto points = random_points(random, 2 + random() % 30);
        const double scale = std::ldexp(1.0, static_cast<int>(random() % 60) - 50);
        for (Point2& point : points) point *= scale;
        const auto found = continuity_of(points, 0.1);
        for (const double value : {found.linearity, found.evenness, found.fill, found.mean()}) {
            ASSERT_TRUE(value >= 0.0 && value <= 1.0) << "round " << round << ": " << value;
        }
    }
}

} // namespace
} // namespace scanloom::landmarks

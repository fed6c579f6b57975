#include "core/landmarks/clustering.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;

double eps_of(const std::vector<Point2>& cloud, std::size_t min_points = 5) {
    return adaptive_eps(distinct_points(cloud), min_points).value();
}

/// Returns the distance that three quarters of the points do not exceed to their k-th nearest other point.
double typical_distance(const std::vector<Point2>& points, std::size_t k) {
    std::vector<double> distances;
    for (const Point2& point : points) {
        std::vector<double> all;
        for (const Point2& other : points) all.push_back(std::hypot(other.x - point.x, other.y - point.y));
        std::ranges::sort(all);
        distances.push_back(all[std::min(k, all.size() - 1)]); // the first is the point itself
    }
    std::ranges::sort(distances);
    for (const double distance : distances) {
        const auto no_more = std::ranges::count_if(distances, [&](double other) { return other <= distance; });
        if (4 * no_more >= 3 * std::ssize(distances)) return distance;
    }
    return 0.0;
}

double eps_oracle(const std::vector<Point2>& cloud, std::size_t min_points) {
    std::map<std::pair<double, double>, Point2> squares;
    for (const Point2& point : cloud)
        squares.try_emplace({std::floor(point.x * 10.0), std::floor(point.y * 10.0)}, point);
    std::vector<Point2> thinned;
    for (const auto& [square, point] : squares) thinned.push_back(point);
    double eps = typical_distance(thinned, 5);
    if (min_points > 5) eps = std::max(eps, typical_distance(cloud, min_points));
    return std::clamp(eps, 0.1, 0.5);
}

TEST(AdaptiveEps, MatchesBruteForceOverAllPairs) {
    std::mt19937 random(1);
    int between = 0;
    for (int round = 0; round < 2000; ++round) {
        auto cloud = random_points(random, random() % 150);
        for (Point2& point : cloud) point *= 0.5; // keeps most results below the maximum
        const std::size_t min_points = 1 + random() % 12;
        const double expected = eps_oracle(cloud, min_points);
        ASSERT_NEAR(eps_of(cloud, min_points), expected, 1e-12) << "round " << round;
        between += expected > 0.1 && expected < 0.5 ? 1 : 0;
    }
    EXPECT_GT(between, 500);
}

TEST(AdaptiveEps, DoesNotShrinkWithMoreTurnsOfAStationaryLidar) {
    std::mt19937 random(2);
    // A wall with one point per 8 cm and 2 cm of noise.
    std::vector<Point2> wall;
    const auto turn = [&] {
        for (int beam = 0; beam < 100; ++beam) {
            wall.push_back({0.08 * beam + uniform(random, -0.01, 0.01), uniform(random, -0.02, 0.02)});
        }
    };
    turn();
    const double one = eps_of(wall);
    for (int n = 1; n < 200; ++n) turn();
    const double many = eps_of(wall);
    EXPECT_GT(one, 0.2);
    EXPECT_GT(many, 0.1);
    EXPECT_EQ(dbscan(wall, many, 5)->clusters, 1U);
}

TEST(AdaptiveEps, IgnoresRepeatedPoints) {
    std::vector<Point2> cloud;
    for (int n = 0; n < 50; ++n) cloud.push_back({0.15 * n, 0.0});
    const double once = eps_of(cloud);
    for (int n = 0; n < 50 * 99; ++n) cloud.push_back(cloud[static_cast<std::size_t>(n)]);
    EXPECT_EQ(eps_of(cloud), once);
}

TEST(AdaptiveEps, GrowsWithMinPointsInASparseCloud) {
    std::vector<Point2> line;
    for (int n = 0; n < 400; ++n) line.push_back({0.025 * n, 0.0});
    EXPECT_NEAR(eps_of(line, 5), 0.3, 0.01); // at most three squares on either side
    EXPECT_NEAR(eps_of(line, 20), 0.3, 0.01);
    EXPECT_NEAR(eps_of(line, 30), 0.375, 1e-9);
    EXPECT_EQ(eps_of(line, 60), kAdaptiveEpsMax);
}

TEST(AdaptiveEps, StaysWithinItsLimits) {
    EXPECT_EQ(eps_of({}), kThinningSide);
    EXPECT_EQ(eps_of({{3.0, 4.0}}), kThinningSide);
    EXPECT_EQ(eps_of(std::vector<Point2>(10'000, Point2{3.0, 4.0}), 7), kThinningSide);
    EXPECT_EQ(eps_of({{0.0, 0.0}, {1000.0, 0.0}}), kAdaptiveEpsMax);
}

TEST(AdaptiveEps, MatchesTheDensityOfALargeCloud) {
    std::mt19937 random(3);
    std::vector<Point2> cloud;
    for (int n = 0; n < 25'000; ++n) cloud.push_back({uniform(random, 0.0, 30.0), uniform(random, 0.0, 30.0)});
    // 12 points within a circle: pi r^2 * 25000 / 900 = 12
    EXPECT_NEAR(eps_of(cloud, 12), 0.42, 0.03);
}

TEST(AdaptiveEps, RefusesMinPointsOutOfRange) {
    for (const std::size_t min_points : {std::size_t{0}, kMinPointsMax + 1}) {
        EXPECT_EQ(adaptive_eps(distinct_points({}), min_points).error().code, Errc::kInvalidField);
    }
}

} // namespace
} // namespace scanloom::landmarks

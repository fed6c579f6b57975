#include "core/landmarks/landmark_matching.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Returns the index of the nearest point, the first one if several are equally near.
std::size_t index_of_nearest(const Point2& place, const std::vector<Point2>& points) {
    std::size_t nearest = 0;
    for (std::size_t n = 1; n < points.size(); ++n) {
        if (squared_norm(points[n] - place) < squared_norm(points[nearest] - place)) nearest = n;
    }
    return nearest;
}

/// Finds matches by comparing all pairs.
std::vector<Match> all_matches(const std::vector<Point2>& first, const std::vector<Point2>& second, double tolerance) {
    std::vector<Match> matches;
    if (second.empty()) return matches;
    for (std::size_t n = 0; n < first.size(); ++n) {
        const std::size_t there = index_of_nearest(first[n], second);
        const double distance = norm(second[there] - first[n]);
        if (index_of_nearest(second[there], first) == n && distance <= tolerance)
            matches.push_back({n, there, distance});
    }
    return matches;
}

TEST(Matching, MatchesBruteForceOverAllPairs) {
    std::mt19937 random(1);
    std::size_t found = 0;
    for (int round = 0; round < 5000; ++round) {
        const auto first = random_points(random, random() % 40);
        const auto second = random_points(random, random() % 40);
        const double tolerance = std::array{0.0, 0.1, 0.25, 0.5, 1.0, 9.0}[random() % 6];
        const auto expected = all_matches(first, second, tolerance);
        ASSERT_EQ(match(first, second, tolerance).value(), expected) << "round " << round;
        found += expected.size();
    }
    EXPECT_GT(found, 10'000U);
}

TEST(Matching, PointsExactlyTheToleranceApartMatch) {
    const std::vector<Point2> first = {{0.0, 0.0}};
    const std::vector<Point2> second = {{kTolerance, 0.0}};
    EXPECT_THAT(match(first, second).value(), ElementsAre(Match{0, 0, kTolerance}));
    EXPECT_THAT(match(first, second, std::nextafter(kTolerance, 0.0)).value(), IsEmpty());
    EXPECT_THAT(match(first, first, 0.0).value(), ElementsAre(Match{0, 0, 0.0}));
}

TEST(Matching, RefusesInvalidPointsAndTolerances) {
    const double nan = std::nan("");
    const double infinite = std::numeric_limits<double>::infinity();
    const std::vector<Point2> good = {{0.0, 0.0}};
    for (const double bad : {nan, infinite, -infinite, 2e7}) {
        const std::vector<Point2> points = {{0.0, 0.0}, {0.0, bad}};
        EXPECT_THAT(match(points, good).error().message, HasSubstr("first[1]")) << bad;
        EXPECT_THAT(match(good, points).error().message, HasSubstr("second[1]")) << bad;
    }
    for (const double bad : {nan, infinite, -0.1}) {
        EXPECT_THAT(match(good, good, bad).error().message, HasSubstr("tolerance")) << bad;
    }
}

} // namespace
} // namespace scanloom::landmarks

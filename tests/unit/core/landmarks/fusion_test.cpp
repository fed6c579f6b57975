#include "core/landmarks/cloud_fusion.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using testing::HasSubstr;
using testing::IsEmpty;
using Cloud = std::vector<Point2>;

double middle(std::vector<double> values) {
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2.0;
}

Point2 middle(const Cloud& points) {
    std::vector<double> x;
    std::vector<double> y;
    for (const Point2& point : points) {
        x.push_back(point.x);
        y.push_back(point.y);
    }
    return {middle(x), middle(y)};
}

std::size_t nearest_of(const Point2& place, const Cloud& points) {
    std::size_t nearest = 0;
    for (std::size_t n = 1; n < points.size(); ++n) {
        if (squared_norm(points[n] - place) < squared_norm(points[nearest] - place)) nearest = n;
    }
    return nearest;
}

/// Computes the groups as defined in the header by comparing all pairs.
std::vector<Cloud> groups_of(const std::vector<Cloud>& clouds, double threshold) {
    std::vector<Cloud> groups;
    for (const Cloud& cloud : clouds) {
        Cloud places;
        for (const Cloud& group : groups) places.push_back(middle(group));
        for (std::size_t n = 0; n < cloud.size(); ++n) {
            const std::size_t group = places.empty() ? 0 : nearest_of(cloud[n], places);
            const bool joins =
                !places.empty() && norm(cloud[n] - places[group]) <= threshold && nearest_of(places[group], cloud) == n;
            if (joins) {
                groups[group].push_back(cloud[n]);
            } else {
                groups.push_back({cloud[n]});
            }
        }
    }
    return groups;
}

TEST(Fusion, MatchesBruteForceOverAllPairs) {
    std::mt19937 random(1);
    std::size_t joined = 0;
    for (int round = 0; round < 3000; ++round) {
        std::vector<Cloud> clouds(random() % 7);
        for (Cloud& cloud : clouds) cloud = random_points(random, random() % 25);
        const double threshold = std::array{0.0, 0.1, 0.25, 0.6}[random() % 4];
        const auto groups = groups_of(clouds, threshold);
        const auto fused = fuse(clouds, threshold).value();
        ASSERT_EQ(fused.size(), groups.size()) << "round " << round;
        for (std::size_t n = 0; n < groups.size(); ++n) {
            ASSERT_EQ(fused[n].position, middle(groups[n])) << "round " << round;
            ASSERT_EQ(fused[n].clouds, groups[n].size());
            joined += groups[n].size() > 2 ? 1 : 0;
        }
    }
    EXPECT_GT(joined, 1000U);
}

TEST(Fusion, FusesCorrespondingPointsToTheirMedianPerAxis) {
    const std::vector<Cloud> clouds = {{{0.0, 0.0}}, {{0.2, 0.1}}, {{0.1, 0.3}}};
    const auto fused = fuse(clouds, 0.5).value();
    ASSERT_EQ(fused.size(), 1U);
    EXPECT_EQ(fused[0].position, (Point2{0.1, 0.1}));
    EXPECT_EQ(fused[0].clouds, 3U);
}

TEST(Fusion, RefusesInvalidPointsAndThresholds) {
    const double nan = std::nan("");
    const double infinite = std::numeric_limits<double>::infinity();
    const std::vector<Cloud> clouds = {{{1.0, 1.0}}, {{2.0, 2.0}}};
    for (const double bad : {nan, infinite, -1.0}) {
        EXPECT_THAT(fuse(clouds, bad).error().message, HasSubstr("threshold")) << bad;
    }
    for (const double bad : {nan, infinite}) {
        const std::vector<Cloud> broken = {{{1.0, 1.0}}, {{2.0, 2.0}, {2.0, bad}}};
        EXPECT_THAT(fuse(broken, 0.1).error().message, HasSubstr("clouds[1][1]"));
    }
}

} // namespace
} // namespace scanloom::landmarks

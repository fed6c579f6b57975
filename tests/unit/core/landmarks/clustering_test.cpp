#include "core/landmarks/clustering.hpp"
#include "tests/unit/core/landmarks/clustering_oracle.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Clustering, MatchesTheDefinition) {
    std::mt19937 random(1);
    std::size_t clusters = 0;
    std::size_t noise = 0;
    for (int round = 0; round < 6000; ++round) {
        const auto points = random_points(random, random() % 90);
        const double eps = round % 2 == 0 ? 0.25 * static_cast<double>(1 + random() % 4) : uniform(random, 0.02, 1.0);
        const std::size_t min_points = 1 + random() % 8;
        const auto expected = ClusteringOracle{points, eps, min_points}.run();
        ASSERT_EQ(dbscan(points, eps, min_points).value(), expected)
            << "round " << round << ", eps " << eps << ", min_points " << min_points;
        clusters += expected.clusters;
        noise += static_cast<std::size_t>(std::ranges::count(expected.cluster_of, kNoise));
    }
    EXPECT_GT(clusters, 10'000U);
    EXPECT_GT(noise, 10'000U);
}

void compare_dense_clouds_with_the_definition(int rounds) {
    std::mt19937 random(2);
    for (int round = 0; round < rounds; ++round) {
        // Groups of hundreds of points, about eps apart from each other.
        std::vector<Point2> points;
        for (int heap = 0; heap < 6; ++heap) {
            const Point2 middle{0.14 * heap, uniform(random, -0.05, 0.05)};
            for (int n = 0; n < 200; ++n) {
                points.push_back(middle + Point2{uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02)});
            }
        }
        const double eps = uniform(random, 0.09, 0.13);
        const std::size_t min_points = 1 + random() % 300;
        ASSERT_EQ(dbscan(points, eps, min_points).value(), (ClusteringOracle{points, eps, min_points}.run()))
            << "round " << round;
    }
}

TEST(Clustering, MatchesTheDefinitionForDenseClouds) { compare_dense_clouds_with_the_definition(10); }

TEST(ClusteringTrials, MatchesTheDefinitionForDenseClouds) { compare_dense_clouds_with_the_definition(100); }

TEST(Clustering, MatchesTheDefinitionFarFromTheOrigin) {
    std::mt19937 random(3);
    for (int round = 0; round < 300; ++round) {
        auto points = random_points(random, 80);
        for (Point2& point : points) point += Point2{1e7 - 8.0, -1e7 + 8.0};
        const double eps = 0.25 * static_cast<double>(1 + random() % 4);
        ASSERT_EQ(dbscan(points, eps, 4).value(), (ClusteringOracle{points, eps, 4}.run())) << "round " << round;
    }
}

TEST(Clustering, AcceptsTheSmallestEpsAtTheFarthestPoint) {
    std::vector<Point2> points;
    for (int n = 0; n < 60; ++n) points.push_back({1e7 - 4e-7 * n, -1e7 + 4e-7 * (n % 3)});
    for (const double eps : {kEpsMin, 1.3e-6, 4e-6}) {
        EXPECT_EQ(dbscan(points, eps, 4).value(), (ClusteringOracle{points, eps, 4}.run())) << eps;
    }
    EXPECT_EQ(dbscan(points, kEpsMax, 4)->clusters, 1U);
}

TEST(Clustering, BorderPointJoinsTheNearestThenFirstCorePoint) {
    // Two core points, the points that make them core points, and one point in the middle.
    std::vector<Point2> points{{0.0, 0.0}};
    for (const double side : {-1.0, 1.0}) {
        for (const Point2& point :
             {Point2{1.0, 0.0}, Point2{2.0, 0.0}, Point2{2.0, 0.0}, Point2{1.0, 1.0}, Point2{1.0, -1.0}}) {
            points.push_back({side * point.x, point.y});
        }
    }
    EXPECT_THAT(dbscan(points, 1.25, 5)->cluster_of, ElementsAre(0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1));
    points[0].x = 0.125;
    EXPECT_THAT(dbscan(points, 1.25, 5)->cluster_of, ElementsAre(1, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1));
}

TEST(Clustering, PointsExactlyEpsApartAreConnected) {
    std::vector<Point2> points;
    for (int n = 0; n < 20; ++n) points.push_back({0.25 * n, 0.0});
    EXPECT_EQ(dbscan(points, 0.25, 3)->clusters, 1U);
    EXPECT_EQ(dbscan(points, std::nextafter(0.25, 0.0), 3)->clusters, 0U);
}

TEST(Clustering, RefusesSettingsOutOfRange) {
    const std::vector<Point2> points{{1.0, 1.0}};
    for (const double eps :
         {0.0, -0.1, 9e-7, 2e6, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const auto clustering = dbscan(points, eps, 5);
        ASSERT_FALSE(clustering) << eps;
        EXPECT_EQ(clustering.error().code, Errc::kInvalidField);
        EXPECT_THAT(clustering.error().message, HasSubstr("eps is "));
    }
    for (const std::size_t min_points : {std::size_t{0}, kMinPointsMax + 1}) {
        const auto clustering = dbscan(points, 0.1, min_points);
        ASSERT_FALSE(clustering);
        EXPECT_EQ(clustering.error().code, Errc::kInvalidField);
        EXPECT_THAT(clustering.error().message, HasSubstr("min_points is "));
    }
}

TEST(Clustering, RefusesPointsThatAreNotFinite) {
    const std::vector<Point2> points{{1.0, 1.0}, {std::numeric_limits<double>::quiet_NaN(), 0.0}};
    ASSERT_FALSE(dbscan(points, 0.1, 5));
    EXPECT_THAT(dbscan(points, 0.1, 5).error().message, HasSubstr("points[1]"));
}

} // namespace
} // namespace scanloom::landmarks

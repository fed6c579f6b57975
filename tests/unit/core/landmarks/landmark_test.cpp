#include "core/landmarks/clustering.hpp"
#include "core/landmarks/landmark.hpp"
#include "tests/unit/core/landmarks/clustering_oracle.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

double median_of(std::vector<double> values) {
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

Landmark landmark_oracle(const std::vector<Point2>& points, double eps) {
    std::vector<double> x;
    std::vector<double> y;
    for (const Point2& point : points) {
        x.push_back(point.x);
        y.push_back(point.y);
    }
    const Point2 position{median_of(x), median_of(y)};
    std::vector<double> distances;
    for (const Point2& point : points) distances.push_back(norm(point - position));
    const auto [left, right] = std::ranges::minmax(x);
    const auto [bottom, top] = std::ranges::minmax(y);
    return {position, points.size(), Point2{right - left, top - bottom}, median_of(distances),
            continuity_of(points, eps).mean()};
}

TEST(Landmark, MatchesBruteForceOverTheClustersPoints) {
    std::mt19937 random(1);
    std::size_t count = 0;
    for (int round = 0; round < 1500; ++round) {
        const auto points = random_points(random, random() % 80);
        const double eps = uniform(random, 0.05, 0.6);
        const std::size_t min_points = 1 + random() % 6;
        const auto clustering = ClusteringOracle{points, eps, min_points}.run();
        std::vector<std::vector<Point2>> members(clustering.clusters);
        for (std::size_t n = 0; n < points.size(); ++n) {
            const auto cluster = clustering.cluster_of[n];
            if (cluster != kNoise) members[static_cast<std::size_t>(cluster)].push_back(points[n]);
        }
        std::vector<Landmark> expected;
        for (const auto& cluster : members) expected.push_back(landmark_oracle(cluster, eps));
        ASSERT_EQ(find_landmarks(points, {min_points, eps}).value(), expected) << "round " << round;
        count += expected.size();
    }
    EXPECT_GT(count, 5000U);
}

TEST(Landmark, AdaptsEpsByDefault) {
    std::mt19937 random(2);
    for (int round = 0; round < 200; ++round) {
        const auto points = random_points(random, 100);
        const auto survey = survey_landmarks(points).value();
        EXPECT_EQ(survey.eps, adaptive_eps(distinct_points(points), 5).value());
        EXPECT_EQ(survey.clustering, dbscan(points, survey.eps, 5).value());
        EXPECT_EQ(survey.landmarks, find_landmarks(points, {5, survey.eps}).value());
    }
}

TEST(Landmark, PositionIsRobustToStrayPoints) {
    std::vector<Point2> points;
    for (int n = 0; n < 101; ++n) points.push_back({0.01 * n, 2.0});
    for (int n = 0; n < 9; ++n) points.push_back({1.0, 2.02 + 0.02 * n});
    const auto landmarks = find_landmarks(points, {5, 0.1}).value();
    ASSERT_THAT(landmarks, SizeIs(1));
    EXPECT_NEAR(landmarks[0].position.x, 0.5, 0.06);
    EXPECT_EQ(landmarks[0].position.y, 2.0);
    EXPECT_EQ(landmarks[0].points, 110U);
    EXPECT_NEAR(landmarks[0].size.x, 1.0, 1e-12);
    EXPECT_NEAR(landmarks[0].size.y, 0.18, 1e-12);
}

TEST(Landmark, EqualPointsAreOneLandmarkWithoutSize) {
    const auto landmarks = find_landmarks(std::vector<Point2>(500, Point2{0.1, 0.7})).value();
    ASSERT_THAT(landmarks, SizeIs(1));
    EXPECT_EQ(landmarks[0], (Landmark{{0.1, 0.7}, 500, {0.0, 0.0}, 0.0, 0.0}));
}

TEST(Landmark, TooFewPointsGiveNoLandmark) {
    EXPECT_THAT(find_landmarks({}).value(), IsEmpty());
    EXPECT_THAT(find_landmarks(std::vector<Point2>{{1.0, 2.0}}).value(), IsEmpty());
    EXPECT_THAT(find_landmarks(std::vector<Point2>(4, Point2{1.0, 2.0})).value(), IsEmpty());
    EXPECT_THAT(survey_landmarks({})->clustering.cluster_of, IsEmpty());
    EXPECT_EQ(survey_landmarks({})->eps, kThinningSide);
}

TEST(Landmark, NamesTheInvalidSetting) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Point2> points(10, Point2{1.0, 2.0});
    EXPECT_THAT(find_landmarks(points, {0}).error().message, HasSubstr("min_points is 0"));
    EXPECT_THAT(find_landmarks(points, {0, 0.1}).error().message, HasSubstr("min_points is 0"));
    EXPECT_THAT(find_landmarks(points, {5, 0.0}).error().message, HasSubstr("eps is 0"));
    EXPECT_THAT(find_landmarks(points, {5, nan}).error().message, HasSubstr("eps is nan"));
    for (const Point2& bad : {Point2{nan, 0.0}, Point2{0.0, HUGE_VAL}, Point2{1e9, 0.0}}) {
        const auto refused = find_landmarks(std::vector<Point2>{{1.0, 2.0}, bad});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, Errc::kInvalidField);
        EXPECT_THAT(refused.error().message, HasSubstr("points[1]"));
    }
}

} // namespace
} // namespace scanloom::landmarks

#include "lab/landmark_comparison.hpp"

#include "tests/unit/lab/drawn_clouds.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace scanloom::lab {
namespace {

TEST(LandmarkComparison, CountsMatchedAndUnmatchedLandmarks) {
    const auto first = seen_bars({{0.0, 0.0}, {4.0, 0.0}, {8.0, 0.0}, {12.0, 0.0}});
    const auto second = seen_bars({{0.0, 0.1}, {4.0, 0.2}, {8.0, 0.6}});
    ASSERT_EQ(first.survey.landmarks.size(), 4U);
    ASSERT_EQ(second.survey.landmarks.size(), 3U);
    const auto comparison = compare(first, second).value();
    EXPECT_EQ(comparison.metrics.matched, 2U);
    EXPECT_EQ(comparison.only_first, 2U);
    EXPECT_EQ(comparison.only_second, 1U);
    EXPECT_DOUBLE_EQ(*comparison.metrics.persistence, 0.5);
    EXPECT_DOUBLE_EQ(*comparison.metrics.stability, 0.5)
        << "0.1 m is within half of the tolerance of 0.25 m, 0.2 m is not";
    EXPECT_NEAR(*comparison.metrics.distance_mean, 0.15, 1e-9);
    EXPECT_NEAR(*comparison.metrics.distance_sigma, 0.05, 1e-9);
    EXPECT_EQ(compare(first, second, 0.7).value().metrics.matched, 3U);
}

TEST(LandmarkComparison, ContinuityIsTheMeanOverAllLandmarks) {
    auto first = seen_bars({{0.0, 0.0}});
    auto second = seen_bars({{0.0, 0.0}, {4.0, 0.0}});
    const auto straight = compare(first, second).value().continuity;
    EXPECT_NEAR(straight.linearity, 1.0, 1e-9);
    EXPECT_NEAR(straight.evenness, 1.0, 1e-6);
    EXPECT_NEAR(straight.fill, 1.0, 1e-9);
    EXPECT_NEAR(first.continuity.at(0).mean(), first.survey.landmarks.at(0).continuity, 1e-12);
    first.continuity[0] = {0.4, 0.1, 1.0};
    second.continuity = {{0.4, 0.1, 1.0}, {1.0, 0.4, 0.4}};
    const auto mean = compare(first, second).value().continuity;
    EXPECT_NEAR(mean.linearity, 0.6, 1e-12);
    EXPECT_NEAR(mean.evenness, 0.2, 1e-12);
    EXPECT_NEAR(mean.fill, 0.8, 1e-12);
}

TEST(LandmarkComparison, IsEmptyWithoutLandmarks) {
    const auto comparison = compare(seen_bars({}), seen_bars({{0.0, 0.0}})).value();
    EXPECT_EQ(comparison.metrics.matched, 0U);
    EXPECT_FALSE(comparison.metrics.persistence);
    EXPECT_EQ(comparison.only_second, 1U);
    EXPECT_EQ(compare(seen_bars({}), seen_bars({})).value().continuity, landmarks::Continuity());
}

TEST(LandmarkComparison, RefusesInvalidPointsAndTolerances) {
    EXPECT_EQ(see_landmarks({{std::numeric_limits<double>::quiet_NaN(), 0.0}}).error().code, Errc::kInvalidField);
    EXPECT_EQ(compare(seen_bars({}), seen_bars({}), -0.1).error().code, Errc::kInvalidField);
}

} // namespace
} // namespace scanloom::lab

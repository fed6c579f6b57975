#include "core/landmarks/landmark_matching.hpp"

#include <gtest/gtest.h>

namespace scanloom::landmarks {
namespace {

TEST(Metrics, MatchTheirDefinitions) {
    const std::vector<Match> matches = {{0, 2, 0.0}, {1, 0, 0.125}, {4, 1, 0.25}, {5, 3, 0.125}};
    const Metrics metrics = metrics_of(matches, 10, 0.25);
    EXPECT_EQ(metrics.matched, 4U);
    EXPECT_DOUBLE_EQ(*metrics.persistence, 0.4);
    EXPECT_DOUBLE_EQ(*metrics.stability, 0.75) << "a distance of exactly half the tolerance is stable";
    EXPECT_DOUBLE_EQ(*metrics.distance_mean, 0.125);
    EXPECT_DOUBLE_EQ(*metrics.distance_sigma, 0.125 / std::sqrt(2.0));
}

TEST(Metrics, OneMatchHasNoDeviation) {
    const std::vector<Match> matches = {{0, 0, 0.2}};
    const Metrics metrics = metrics_of(matches, 1, 0.25);
    EXPECT_EQ(metrics.persistence, 1.0);
    EXPECT_EQ(metrics.stability, 0.0);
    EXPECT_EQ(metrics.distance_mean, 0.2);
    EXPECT_EQ(metrics.distance_sigma, 0.0);
}

TEST(Metrics, AreNulloptIfTheDenominatorIsZero) {
    const Metrics unmatched = metrics_of({}, 7);
    EXPECT_EQ(unmatched.matched, 0U);
    EXPECT_EQ(unmatched.persistence, 0.0);
    EXPECT_EQ(unmatched.stability, std::nullopt);
    EXPECT_EQ(unmatched.distance_mean, std::nullopt);
    EXPECT_EQ(unmatched.distance_sigma, std::nullopt);
    EXPECT_EQ(metrics_of({}, 0).persistence, std::nullopt);
}

} // namespace
} // namespace scanloom::landmarks

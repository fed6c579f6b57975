#include "core/landmarks/acceptance_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace scanloom::landmarks {
namespace {

using testing::HasSubstr;

constexpr std::size_t kElements = 400; // number of surface elements of a view, each 10 cm of a line
constexpr Pose2 kBest{0.0, 0.0, 0.0};
constexpr Pose2 kNear{0.2, 0.0, 0.0};
constexpr Pose2 kElsewhere{3.0, 0.0, 0.0};

/// Returns a candidate in which this many of the view's elements are unseen or outliers; all others are inliers.
Candidate candidate_at(const Pose2& pose, std::size_t unseen = 0, std::size_t outliers = 0) {
    Candidate candidate;
    candidate.fit.T_first_second = pose;
    candidate.fit.used = kElements;
    candidate.fit.rms = 0.005;
    candidate.fit.normal_matrix = kElements * Eigen::Vector3d(0.5, 0.5, 1.0).asDiagonal().toDenseMatrix();
    candidate.second_in_first = {kElements - unseen - outliers, outliers, kElements};
    return candidate;
}

Alignment tested(std::vector<Candidate> candidates) {
    rank(candidates);
    return test_acceptance(candidates);
}

bool is_clear(const Candidate& best, const Candidate& other) {
    return tested({best, other}).certainty == Certainty::kClear;
}

void expect_undetermined(const Candidate& candidate, const char* why) {
    const auto alignment = tested({candidate});
    EXPECT_EQ(alignment.certainty, Certainty::kUndetermined);
    EXPECT_THAT(alignment.why, HasSubstr(why));
}

TEST(AcceptanceTest, CandidateIsRejectedByEightPercentOfTheScore) {
    for (const Pose2& pose : {kNear, kElsewhere}) {
        EXPECT_FALSE(is_clear(candidate_at(kBest), candidate_at(pose, 32)));
        EXPECT_TRUE(is_clear(candidate_at(kBest), candidate_at(pose, 33)));
        EXPECT_FALSE(is_clear(candidate_at(kBest), candidate_at(pose, 0, 16)));
        EXPECT_TRUE(is_clear(candidate_at(kBest), candidate_at(pose, 0, 17))) << "an outlier counts twice";
    }
}

TEST(AcceptanceTest, NearlyEqualPoseIsTheSameResult) {
    EXPECT_TRUE(is_clear(candidate_at(kBest), candidate_at({0.09, 0.0, 0.05})));
    EXPECT_FALSE(is_clear(candidate_at(kBest), candidate_at({0.0, 0.0, 0.06})));
}

TEST(AcceptanceTest, DistantCandidateCompetesIfTheMapMayBeIncomplete) {
    const auto best = candidate_at(kBest, 20);
    const auto alignment = tested({best, candidate_at(kElsewhere, 280)});
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
    EXPECT_EQ(alignment.competing_pose, kElsewhere);
    EXPECT_THAT(alignment.why, HasSubstr("matches 30 % of the view, and this pose matches 95 %"));
    EXPECT_FALSE(is_clear(best, candidate_at({0.0, 0.0, 0.3}, 280))) << "a rotated pose is a distant pose, too";
    EXPECT_TRUE(is_clear(best, candidate_at(kElsewhere, 281))) << "the other candidate has almost no overlap";
    EXPECT_TRUE(is_clear(best, candidate_at(kNear, 280)));
    EXPECT_TRUE(is_clear(best, candidate_at(kElsewhere, 279, 1))) << "the other candidate has more outliers";
    EXPECT_TRUE(is_clear(candidate_at(kBest, 12), candidate_at(kElsewhere, 280))) << "the whole view is found";
}

TEST(AcceptanceTest, SmallOverlapIsUndetermined) {
    EXPECT_EQ(tested({candidate_at(kBest, 200)}).certainty, Certainty::kClear);
    expect_undetermined(candidate_at(kBest, 201), "only 50 % of the view is in the map (199 surface elements)");
    EXPECT_THAT(tested({}).why, HasSubstr("does not match the map in any pose"));
}

TEST(AcceptanceTest, HighOutlierRatioIsUndetermined) {
    EXPECT_EQ(tested({candidate_at(kBest, 0, 24)}).certainty, Certainty::kClear);
    expect_undetermined(candidate_at(kBest, 0, 25), "6 % of the view is in the free space of the map");
    auto candidate = candidate_at(kBest);
    candidate.first_in_second = {0, 70, 70};
    EXPECT_EQ(tested({candidate}).certainty, Certainty::kClear);
    candidate.first_in_second = {0, 71, 71};
    expect_undetermined(candidate, "15 % of the surface visible from both places is in one view only");
}

TEST(AcceptanceTest, UncertainPositionIsUndetermined) {
    auto candidate = candidate_at(kBest);
    candidate.fit.rms = 0.13;
    EXPECT_EQ(tested({candidate}).certainty, Certainty::kClear);
    candidate.fit.rms = 0.14;
    expect_undetermined(candidate, "is uncertain by 11 cm");
}

TEST(AcceptanceTest, UnconstrainedDirectionIsAmbiguous) {
    auto candidate = candidate_at(kBest);
    candidate.fit.normal_matrix(0, 0) = 0.019 * kElements;
    const auto alignment = tested({candidate});
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
    EXPECT_THAT(alignment.why, HasSubstr("0.00) is not determined, as in a corridor"));
    candidate.fit.normal_matrix(0, 0) = 0.021 * kElements;
    EXPECT_EQ(tested({candidate}).certainty, Certainty::kClear);
}

} // namespace
} // namespace scanloom::landmarks

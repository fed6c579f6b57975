#include "core/landmarks/acceptance_test.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace scanloom::landmarks {
namespace {

using enum Finding;
using testing::HasSubstr;

constexpr std::size_t kElements = 400; // number of surface elements of two views, each 10 cm of a line
constexpr Pose2 kBest{0.0, 0.0, 0.0};
constexpr Pose2 kNear{0.2, 0.0, 0.0};
constexpr Pose2 kElsewhere{3.0, 0.0, 0.0};

/// A candidate pose that matches all surface elements except those changed by with().
class CandidateAt {
public:
    explicit CandidateAt(const Pose2& pose) : findings_(kElements, kInlier) {
        candidate_.fit.T_first_second = pose;
        candidate_.fit.used = kElements;
        candidate_.fit.rms = 0.005;
        candidate_.fit.normal_matrix = kElements * Eigen::Vector3d(0.5, 0.5, 1.0).asDiagonal().toDenseMatrix();
    }

    /// Sets `count` findings, starting at element `first` with a stride of `step`.
    CandidateAt& with(Finding finding, std::size_t count, std::size_t first = 0, std::size_t step = 1) {
        for (std::size_t n = 0; n < count; ++n) findings_[first + n * step] = finding;
        return *this;
    }

    operator Candidate() const { // NOLINT: implicit conversion keeps the tests short
        Candidate candidate = candidate_;
        candidate.findings = findings_;
        candidate.second_in_first = evidence_of(findings_);
        for (std::size_t n = 0; n < kElements; ++n) candidate.places.push_back({0.1 * static_cast<double>(n), 0.0});
        return candidate;
    }

private:
    Candidate candidate_;
    std::vector<Finding> findings_;
};

Alignment tested(const Candidate& best, const Candidate& other) {
    std::vector<Candidate> candidates = {best, other};
    rank(candidates);
    return test_acceptance(candidates, MatchedAgainst::kView);
}

bool is_clear(const Candidate& best, const Candidate& other) {
    return tested(best, other).certainty == Certainty::kClear;
}

TEST(AcceptanceTest, NearCandidateIsRejectedByFewElements) {
    EXPECT_TRUE(is_clear(CandidateAt(kBest), CandidateAt(kNear).with(kUnseen, 25, 0, 10)));
    EXPECT_FALSE(is_clear(CandidateAt(kBest), CandidateAt(kNear).with(kUnseen, 19, 0, 10)))
        << "too few elements differ";
    EXPECT_TRUE(is_clear(CandidateAt(kBest), CandidateAt(kNear).with(kOutlier, 9, 0, 40)))
        << "a contradiction counts three times";
}

TEST(AcceptanceTest, OneObjectDoesNotDistinguishCandidates) {
    EXPECT_FALSE(is_clear(CandidateAt(kBest), CandidateAt(kNear).with(kUnseen, 20)))
        << "a single object may have moved";
    EXPECT_FALSE(is_clear(CandidateAt(kBest), CandidateAt(kNear).with(kUnseen, 20).with(kUnseen, 9, 100, 30)));
    EXPECT_TRUE(is_clear(CandidateAt(kBest), CandidateAt(kNear).with(kUnseen, 16).with(kUnseen, 10, 100, 30)));
}

TEST(AcceptanceTest, BalancedEvidenceDoesNotDistinguishCandidates) {
    const auto best = CandidateAt(kBest).with(kUnseen, 12, 5, 10);
    EXPECT_FALSE(is_clear(best, CandidateAt(kNear).with(kUnseen, 35, 0, 10)))
        << "35 elements against 12 is less than a factor of three";
    EXPECT_TRUE(is_clear(best, CandidateAt(kNear).with(kUnseen, 37, 0, 10)));
}

TEST(AcceptanceTest, DistantCandidateIsRejectedByManyElements) {
    EXPECT_FALSE(is_clear(CandidateAt(kBest), CandidateAt(kElsewhere).with(kUnseen, 38, 0, 10)));
    EXPECT_TRUE(is_clear(CandidateAt(kBest), CandidateAt(kElsewhere).with(kUnseen, 41, 0, 9)));
    EXPECT_FALSE(is_clear(CandidateAt(kBest), CandidateAt({0.0, 0.0, 0.3}).with(kUnseen, 38, 0, 10)))
        << "a rotated pose is a distant pose, too";
    EXPECT_FALSE(is_clear(CandidateAt(kBest), CandidateAt(kElsewhere).with(kOutlier, 8, 0, 45)))
        << "too few elements differ";
}

TEST(AcceptanceTest, LessContradictedDistantCandidateIsAmbiguous) {
    const auto best = CandidateAt(kBest).with(kOutlier, 10);
    const auto other = CandidateAt(kElsewhere).with(kUnseen, 120, 20);
    const auto alignment = tested(best, other);
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
    EXPECT_EQ(alignment.competing_pose, kElsewhere);
    EXPECT_THAT(
        alignment.why,
        HasSubstr("matches 70 % of the view, and this pose matches 98 %, but the other one has fewer outliers"));
    EXPECT_TRUE(is_clear(best, CandidateAt(kElsewhere).with(kUnseen, 140, 20)));
    EXPECT_TRUE(is_clear(best, CandidateAt(kElsewhere).with(kUnseen, 120, 20).with(kOutlier, 5)));
    EXPECT_TRUE(is_clear(CandidateAt(kBest).with(kOutlier, 39), CandidateAt(kElsewhere).with(kUnseen, 281)))
        << "the other candidate has almost no overlap";
}

TEST(AcceptanceTest, HighOutlierRatioIsUndetermined) {
    const auto nothing = CandidateAt(kElsewhere).with(kUnseen, kElements);
    EXPECT_TRUE(is_clear(CandidateAt(kBest).with(kOutlier, 40), nothing));
    const auto alignment = tested(CandidateAt(kBest).with(kOutlier, 41), nothing);
    EXPECT_EQ(alignment.certainty, Certainty::kUndetermined);
    EXPECT_THAT(alignment.why, HasSubstr("10 % of the surface visible from both places is in one view only"));
}

} // namespace
} // namespace scanloom::landmarks

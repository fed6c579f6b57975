#include "server/landmarks/alignment_judgement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace scanloom::landmarks {
namespace {

using enum Finding;
using testing::HasSubstr;

constexpr std::size_t kElements = 400; // of two views, 10 cm of a line each
constexpr Pose2 kBest{0.0, 0.0, 0.0};
constexpr Pose2 kBeside{0.2, 0.0, 0.0};
constexpr Pose2 kElsewhere{3.0, 0.0, 0.0};

/// A pose that explains all but what is said.
class Laid {
public:
    explicit Laid(const Pose2& pose) : findings_(kElements, kMatched) {
        candidate_.fit.T_first_second = pose;
        candidate_.fit.used = kElements;
        candidate_.fit.rms = 0.005;
        candidate_.fit.normal_matrix = kElements * Eigen::Vector3d(0.5, 0.5, 1.0).asDiagonal().toDenseMatrix();
    }

    /// Of the elements from `first` on, each `step`-th.
    Laid& with(Finding finding, std::size_t count, std::size_t first = 0, std::size_t step = 1) {
        for (std::size_t n = 0; n < count; ++n) findings_[first + n * step] = finding;
        return *this;
    }

    operator Candidate() const { // NOLINT: it stands for one
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

Alignment judged(const Candidate& best, const Candidate& other) {
    std::vector<Candidate> candidates = {best, other};
    rank(candidates);
    return judge(candidates, LaidOn::kView);
}

bool is_clear(const Candidate& best, const Candidate& other) {
    return judged(best, other).certainty == Certainty::kClear;
}

TEST(Judgement, WhatIsBesideTheBestIsToldFromItByWhatFewElementsSay) {
    EXPECT_TRUE(is_clear(Laid(kBest), Laid(kBeside).with(kUnseen, 25, 0, 10)));
    EXPECT_FALSE(is_clear(Laid(kBest), Laid(kBeside).with(kUnseen, 19, 0, 10))) << "by too few";
    EXPECT_TRUE(is_clear(Laid(kBest), Laid(kBeside).with(kContradicted, 9, 0, 40))) << "a contradiction counts thrice";
}

TEST(Judgement, OneThingAloneTellsNothingApart) {
    EXPECT_FALSE(is_clear(Laid(kBest), Laid(kBeside).with(kUnseen, 20))) << "it may have moved";
    EXPECT_FALSE(is_clear(Laid(kBest), Laid(kBeside).with(kUnseen, 20).with(kUnseen, 9, 100, 30)));
    EXPECT_TRUE(is_clear(Laid(kBest), Laid(kBeside).with(kUnseen, 16).with(kUnseen, 10, 100, 30)));
}

TEST(Judgement, WhatSpeaksForBothTellsThemNotApart) {
    const auto best = Laid(kBest).with(kUnseen, 12, 5, 10);
    EXPECT_FALSE(is_clear(best, Laid(kBeside).with(kUnseen, 35, 0, 10))) << "35 and 12: less than three times as many";
    EXPECT_TRUE(is_clear(best, Laid(kBeside).with(kUnseen, 37, 0, 10)));
}

TEST(Judgement, WhatIsElsewhereHasToExplainMuchLess) {
    EXPECT_FALSE(is_clear(Laid(kBest), Laid(kElsewhere).with(kUnseen, 38, 0, 10)));
    EXPECT_TRUE(is_clear(Laid(kBest), Laid(kElsewhere).with(kUnseen, 41, 0, 9)));
    EXPECT_FALSE(is_clear(Laid(kBest), Laid({0.0, 0.0, 0.3}).with(kUnseen, 38, 0, 10))) << "turned is elsewhere, too";
    EXPECT_FALSE(is_clear(Laid(kBest), Laid(kElsewhere).with(kContradicted, 8, 0, 45))) << "few elements tell nothing";
}

TEST(Judgement, WhatIsElsewhereAndLessContradictedMayExplainLess) {
    const auto best = Laid(kBest).with(kContradicted, 10);
    const auto other = Laid(kElsewhere).with(kUnseen, 120, 20);
    const auto alignment = judged(best, other);
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
    EXPECT_EQ(alignment.rival, kElsewhere);
    EXPECT_THAT(alignment.why, HasSubstr("explains 70 % where this one explains 98 %, and less speaks against it"));
    EXPECT_TRUE(is_clear(best, Laid(kElsewhere).with(kUnseen, 140, 20)));
    EXPECT_TRUE(is_clear(best, Laid(kElsewhere).with(kUnseen, 120, 20).with(kContradicted, 5)));
    EXPECT_TRUE(is_clear(Laid(kBest).with(kContradicted, 39), Laid(kElsewhere).with(kUnseen, 281)))
        << "hardly anything of it overlaps";
}

TEST(Judgement, MuchThatIsContradictedDeterminesNothing) {
    const auto nothing = Laid(kElsewhere).with(kUnseen, kElements);
    EXPECT_TRUE(is_clear(Laid(kBest).with(kContradicted, 40), nothing));
    const auto alignment = judged(Laid(kBest).with(kContradicted, 41), nothing);
    EXPECT_EQ(alignment.certainty, Certainty::kUndetermined);
    EXPECT_THAT(alignment.why, HasSubstr("10 % of what both could see is in one of the two alone"));
}

} // namespace
} // namespace scanloom::landmarks

#include "lab/alignment_trials.hpp"

#include "lab/each_index.hpp"
#include "tests/support/angles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

namespace scanloom::lab {
namespace {

using landmarks::Certainty;
using testing::Each;

landmarks::Alignment found_at(const Pose2& pose, Certainty certainty = Certainty::kClear) {
    landmarks::Alignment found;
    found.T_first_second = pose;
    found.certainty = certainty;
    return found;
}

Verdict verdict(const landmarks::Alignment& found, const std::optional<Pose2>& ground_truth) {
    return trial_of(1, found, ground_truth).verdict;
}

TEST(Trials, ClearTrialIsRightWithinTwoCentimetresAndHalfADegree) {
    const Pose2 ground_truth{1.0, 2.0, 3.1};
    EXPECT_EQ(verdict(found_at({1.012, 2.015, 3.1}), ground_truth), Verdict::kRight);
    EXPECT_EQ(verdict(found_at({1.015, 2.015, 3.1}), ground_truth), Verdict::kWrong);
    EXPECT_EQ(verdict(found_at({1.0, 2.0, 3.1 + 0.4 * kDegree}), ground_truth), Verdict::kRight);
    EXPECT_EQ(verdict(found_at({1.0, 2.0, 3.1 - 0.6 * kDegree}), ground_truth), Verdict::kWrong);
    EXPECT_EQ(verdict(found_at({1.0, 2.0, 3.1 - 2.0 * std::numbers::pi}), ground_truth), Verdict::kRight);
    EXPECT_EQ(verdict(found_at({9.0, 9.0, 0.0}, Certainty::kAmbiguous), ground_truth), Verdict::kAmbiguous);
    EXPECT_EQ(verdict(found_at(ground_truth, Certainty::kUndetermined), ground_truth), Verdict::kUndetermined);
}

TEST(Trials, ClearTrialInAnotherWorldIsWrong) {
    EXPECT_EQ(verdict(found_at({}), std::nullopt), Verdict::kWrong);
    EXPECT_EQ(verdict(found_at({}, Certainty::kAmbiguous), std::nullopt), Verdict::kAmbiguous);
    EXPECT_EQ(verdict(found_at({}, Certainty::kUndetermined), std::nullopt), Verdict::kUndetermined);
}

TEST(Trials, WorstErrorIsThatOfRightTrials) {
    const Trials trials{.each = {{1, Verdict::kRight, {}, {0.003, 0.002}},
                                 {2, Verdict::kWrong, {}, {3.0, 2.0}},
                                 {3, Verdict::kRight, {}, {0.001, 0.004}},
                                 {4, Verdict::kAmbiguous, {}, {5.0, 0.0}}}};
    EXPECT_EQ(trials.count(Verdict::kRight), 2U);
    EXPECT_EQ(trials.count(Verdict::kWrong), 1U);
    EXPECT_EQ(trials.count(Verdict::kUndetermined), 0U);
    EXPECT_DOUBLE_EQ(trials.worst().metres, 0.003);
    EXPECT_DOUBLE_EQ(trials.worst().radians, 0.004);
    EXPECT_EQ(Trials{}.worst().metres, 0.0);
}

TEST(Trials, EachSceneIsTriedOnceInSeedOrder) {
    double time = 0.0;
    const auto now = [&] { return time += 2.0; };
    const auto trials =
        try_scenes(3, 50, now, [](std::uint64_t seed) -> Result<Trial> { return Trial{.seed = seed}; }).value();
    ASSERT_EQ(trials.each.size(), 50U);
    for (std::size_t n = 0; n < 50; ++n) EXPECT_EQ(trials.each[n].seed, 3 * kScenes + n);
    EXPECT_EQ(trials.seconds, 2.0);
    EXPECT_GT(scene_seed(4, 0), scene_seed(3, kScenes - 1)) << "other seeds must have other scenes";
}

TEST(Trials, FirstFailingSceneIsAnErrorWithItsSeed) {
    const auto trials = try_scenes(
        1, 20, [] { return 0.0; },
        [](std::uint64_t seed) -> Result<Trial> {
            if (seed % 7 == 0) return Error{Errc::kInvalidField, "too few points"};
            return Trial{};
        });
    ASSERT_FALSE(trials);
    EXPECT_EQ(trials.error().message, "scene 105: too few points");
}

TEST(EachIndex, IsVisitedOnceAndExceptionsPropagate) {
    std::vector<int> visits(1000, 0);
    for_each_index(visits.size(), [&](std::size_t n) { ++visits[n]; });
    EXPECT_THAT(visits, Each(1));
    for_each_index(0, [](std::size_t) { FAIL(); });
    EXPECT_THROW(for_each_index(9,
                                [](std::size_t n) {
                                    if (n == 5) throw std::runtime_error("no");
                                }),
                 std::runtime_error);
}

} // namespace
} // namespace scanloom::lab

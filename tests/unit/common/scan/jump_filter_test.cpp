#include "common/scan/scan_filter.hpp"

#include <gtest/gtest.h>

#include <string>

namespace scanloom {
namespace {

/// Returns the decision for each scan of one robot on a line: '+' integrated, '-' omitted.
std::string decisions(double max_jump_m, const std::vector<double>& places) {
    JumpFilter filter(max_jump_m);
    std::string text;
    for (const double x : places) text += filter.take(0, {x, 0.0}) ? '+' : '-';
    return text;
}

TEST(JumpFilter, OneWrongPoseOmitsOneScan) { EXPECT_EQ(decisions(1.0, {0.0, 0.5, 450.0, 1.0, 1.5}), "++-++"); }

TEST(JumpFilter, CarriedRobotOmitsOneScan) { EXPECT_EQ(decisions(1.0, {0.0, 0.5, 9.0, 9.5, 10.0}), "++-++"); }

TEST(JumpFilter, WrongFirstPoseOmitsTheNextScan) { EXPECT_EQ(decisions(1.0, {450.0, 0.0, 0.5}), "+-+"); }

TEST(JumpFilter, JumpOfExactlyTheMaximumIsAccepted) { EXPECT_EQ(decisions(1.0, {0.0, 1.0, 2.0, 3.001}), "+++-"); }

TEST(JumpFilter, ZeroDisablesTheFilter) { EXPECT_EQ(decisions(0.0, {0.0, 1e6, -1e6}), "+++"); }

TEST(JumpFilter, RobotsAreIndependent) {
    JumpFilter filter(1.0);
    EXPECT_TRUE(filter.take(3, {0.0, 0.0}));
    EXPECT_TRUE(filter.take(1, {100.0, 0.0}));
    EXPECT_FALSE(filter.take(3, {100.0, 0.0}));
    EXPECT_EQ(filter.state(3).left_out, 1U);
    EXPECT_EQ(filter.state(1).left_out, 0U);
    EXPECT_EQ(filter.state(7), JumpFilter::Robot{});
}

TEST(JumpFilter, ContinuesFromARestoredState) {
    JumpFilter filter(1.0);
    for (const double x : {0.0, 0.5, 9.0}) filter.take(0, {x, 0.0});
    JumpFilter other(1.0);
    other.restore(0, filter.state(0));
    EXPECT_TRUE(other.integrates(0, {9.5, 0.0}));
    EXPECT_TRUE(other.integrates(0, {1.0, 0.0}));
    EXPECT_FALSE(other.integrates(0, {5.0, 0.0}));
    EXPECT_EQ(other.state(0).left_out, 1U);
}

TEST(ScanFilter, ScanWithoutAPoseIsUnplacedAndNoJump) {
    ScanFilter filter(1.0);
    const auto use_at = [&](std::uint64_t seq, std::optional<Pose2> pose) {
        const ScanPose scan{0, seq, 0.0, pose};
        const auto expected = filter.use_of(seq, scan);
        EXPECT_EQ(filter.take(seq, scan), expected);
        return expected;
    };
    EXPECT_EQ(use_at(1, Pose2{}), ScanUse::kIntegrated);
    EXPECT_EQ(use_at(2, std::nullopt), ScanUse::kUnplaced);
    EXPECT_EQ(use_at(3, Pose2{0.9, 0.0, 0.0}), ScanUse::kIntegrated);
    EXPECT_EQ(use_at(4, Pose2{5.0, 0.0, 0.0}), ScanUse::kJump);
    EXPECT_EQ(filter.jumps().state(0).left_out, 1U);
}

TEST(ScanFilter, ExclusionGoesBeforeAMissingPose) {
    Exclusions exclusions;
    ASSERT_TRUE(exclusions.add(9, ScansExcluded{1, 0, SeqRange{1, 1}}));
    ScanFilter filter(0.0, std::make_shared<const Exclusions>(exclusions));
    EXPECT_EQ(filter.take(1, {0, 1, 0.0, std::nullopt}), ScanUse::kExcluded);
    EXPECT_EQ(filter.take(2, {0, 2, 0.0, std::nullopt}), ScanUse::kUnplaced);
}

} // namespace
} // namespace scanloom

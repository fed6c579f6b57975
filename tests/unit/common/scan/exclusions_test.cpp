#include "common/scan/scan_filter.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>

namespace scanloom {
namespace {

ScanPose scan_of(RobotIndex robot, std::uint64_t seq, double stamp) { return {robot, seq, stamp, {}}; }

TEST(Exclusions, CoverOnlyEarlierScansOfTheRobotInTheRange) {
    Exclusions exclusions;
    ASSERT_TRUE(exclusions.add(10, ScansExcluded{1, 0, StampRange{5.0, 7.0}}));
    EXPECT_TRUE(exclusions.cover(9, scan_of(0, 1, 5.0)));
    EXPECT_TRUE(exclusions.cover(1, scan_of(0, 1, 7.0)));
    EXPECT_FALSE(exclusions.cover(9, scan_of(0, 1, 4.9)));
    EXPECT_FALSE(exclusions.cover(9, scan_of(0, 1, 7.1)));
    EXPECT_FALSE(exclusions.cover(9, scan_of(1, 1, 6.0))) << "a scan of another robot";
    EXPECT_FALSE(exclusions.cover(11, scan_of(0, 1, 6.0))) << "a later log entry";

    ASSERT_TRUE(exclusions.add(12, ScansExcluded{2, 1, SeqRange{3, 4}}));
    EXPECT_TRUE(exclusions.cover(11, scan_of(1, 3, 0.0)));
    EXPECT_TRUE(exclusions.cover(11, scan_of(1, 4, 0.0)));
    EXPECT_FALSE(exclusions.cover(11, scan_of(1, 5, 0.0)));
    EXPECT_FALSE(exclusions.cover(11, scan_of(0, 1, 6.0))) << "the scan follows the first exclusion";
}

TEST(Exclusions, LiftedExclusionHasNoEffect) {
    Exclusions exclusions;
    ASSERT_TRUE(exclusions.add(10, ScansExcluded{1, 0, StampRange{5.0, 7.0}}));
    ASSERT_TRUE(exclusions.add(20, ExclusionLifted{1}));
    EXPECT_FALSE(exclusions.cover(9, scan_of(0, 1, 6.0)));
    EXPECT_EQ(exclusions.count_in_effect(), 0U);
    EXPECT_EQ(exclusions.revision(), 20U);
    EXPECT_TRUE(exclusions.as_of(19).cover(9, scan_of(0, 1, 6.0)));
    EXPECT_EQ(exclusions.as_of(19).revision(), 10U);
}

TEST(Exclusions, RefuseEntriesOutOfSequence) {
    Exclusions exclusions;
    EXPECT_EQ(exclusions.add(1, ExclusionLifted{1}).error().code, Errc::kMalformed);
    ASSERT_TRUE(exclusions.add(2, ScansExcluded{3, 0, SeqRange{1, 1}}));
    EXPECT_EQ(exclusions.add(3, ScansExcluded{3, 0, SeqRange{1, 1}}).error().code, Errc::kMalformed);
    ASSERT_TRUE(exclusions.add(4, ExclusionLifted{3}));
    EXPECT_EQ(exclusions.add(5, ExclusionLifted{3}).error().code, Errc::kMalformed);
    EXPECT_EQ(exclusions.revision(), 4U);
}

TEST(Exclusions, AsOfARevisionContainEarlierExclusions) {
    std::mt19937 random(1);
    Exclusions all;
    std::vector<Exclusions> prefixes = {all};
    std::uint64_t id = 0;
    for (Revision revision = 1; revision <= 60; ++revision) {
        if (random() % 3 == 0) {
            static_cast<void>(all.add(revision, ExclusionLifted{1 + random() % (id + 1)})); // some entries are refused
        } else if (random() % 2 == 0) {
            ASSERT_TRUE(all.add(revision, ScansExcluded{++id, 0, SeqRange{random() % 9, 9}}));
        }
        prefixes.push_back(all);
    }
    for (Revision revision = 0; revision <= 60; ++revision) ASSERT_EQ(all.as_of(revision), prefixes[revision]);
}

TEST(ScanFilter, MaxJumpIgnoresExcludedScans) {
    auto exclusions = std::make_shared<Exclusions>();
    ASSERT_TRUE(exclusions->add(9, ScansExcluded{1, 0, SeqRange{2, 3}}));
    ScanFilter filter(1.0, exclusions);
    const auto use_of = [&](std::uint64_t seq, double x) {
        return filter.take(seq, ScanPose{0, seq, 0.0, Pose2{x, 0.0, 0.0}});
    };
    EXPECT_EQ(use_of(1, 0.0), ScanUse::kIntegrated);
    EXPECT_EQ(use_of(2, 40.0), ScanUse::kExcluded);
    EXPECT_EQ(use_of(3, 40.5), ScanUse::kExcluded);
    EXPECT_EQ(use_of(4, 40.9), ScanUse::kJump) << "only the excluded scans are near";
    EXPECT_EQ(use_of(5, 0.5), ScanUse::kIntegrated);
}

TEST(ScanFilter, ScansOfLocalizeOnlyModeAreInTheTrajectoryUnlessTheyJump) {
    ScanFilter filter(1.0);
    const auto use_of = [&](std::uint64_t seq, std::optional<Pose2> pose, bool is_localize_only) {
        return filter.take(seq, ScanPose{0, seq, 0.0, pose, is_localize_only});
    };
    EXPECT_EQ(use_of(1, Pose2{}, true), ScanUse::kLocalizeOnly);
    EXPECT_EQ(use_of(2, Pose2{0.9, 0.0, 0.0}, false), ScanUse::kIntegrated);
    EXPECT_EQ(use_of(3, Pose2{9.0, 0.0, 0.0}, true), ScanUse::kJump);
    EXPECT_EQ(use_of(4, std::nullopt, true), ScanUse::kUnplaced);
    EXPECT_EQ(use_of(5, Pose2{1.8, 0.0, 0.0}, true), ScanUse::kLocalizeOnly);
    for (const auto use : {ScanUse::kJump, ScanUse::kUnplaced, ScanUse::kExcluded}) {
        EXPECT_FALSE(is_in_trajectory(use));
    }
}

} // namespace
} // namespace scanloom

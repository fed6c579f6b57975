#include "server/sessions/replay_job.hpp"
#include "tests/support/captured_log.hpp"
#include "tests/unit/server/sessions/estimated_poses_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace scanloom::sessions {
namespace {

TEST_F(EstimatedPosesTest, LoopClosuresCorrectTheMaps) {
    drive_on(20);
    const auto maps = session_->snapshot();
    EXPECT_EQ(maps->moving_scans, 0U);
    EXPECT_EQ(maps->robots[0].scan_count, lap().scans.size());
    const auto announced = announcements();
    ASSERT_FALSE(announced.empty());
    EXPECT_EQ(maps->scan_poses.corrected(), announced.back());
    EXPECT_EQ(digest(), digest_with_poses_in_maps());
    const auto poses = state().poses;
    EXPECT_LT(slam::largest_error(lap(), [&](std::size_t n) { return poses[n].pose; }), 0.2) << "of 14 m";
    const auto& trajectory = maps->robots[0].trajectory;
    for (std::size_t n = 0; n < trajectory.size(); ++n) {
        ASSERT_EQ(trajectory[n].pose, maps->scan_poses.find(0, n + 1));
    }
}

TEST_F(EstimatedPosesTest, ARobotReceivesWhereItIsAfterEachGroup) {
    constexpr std::size_t kScans = 60;
    const auto newest_of = [&](const LocatedLink& link) {
        EXPECT_EQ(link.located.size(), kScans / 20) << "one for each group with a scan";
        const Located newest = link.located.back();
        EXPECT_EQ(newest.revision, session_->snapshot()->revision);
        EXPECT_EQ(newest.state, LocalizationState::kTracking);
        const auto known = session_->snapshot()->robots[0].localization;
        EXPECT_EQ(newest.inlier_ratio, known.inlier_ratio);
        EXPECT_EQ(newest.position_sigma, known.position_sigma);
        EXPECT_EQ(newest.yaw_sigma, known.yaw_sigma);
        return newest.T_map_odom;
    };
    const Pose2 T_map_odom = newest_of(*drive_on(20, kScans));
    const Pose2 pose = state().poses.back().pose;
    const Pose2 composed = compose(T_map_odom, lap().odometry[kScans - 1]);
    EXPECT_NEAR(composed.x, pose.x, 1e-9);
    EXPECT_NEAR(composed.y, pose.y, 1e-9);
    EXPECT_NEAR(composed.yaw, pose.yaw, 1e-9);

    id_ = log_.create_session("an unused record").value();
    start_session();
    const Pose2 T_map_robot = newest_of(*drive_on(20, kScans, Poses::kNone));
    EXPECT_EQ(T_map_robot, state().poses.back().pose) << "without odometry the robot is its odometry frame";
}

TEST_F(EstimatedPosesTest, ARobotThatSendsPosesIsNotLocated) {
    EXPECT_THAT(drive_on(20, 40, Poses::kMap)->located, testing::IsEmpty());
}

TEST_F(EstimatedPosesTest, BatchesDoNotMatter) {
    drive_on(100);
    const State expected = state();
    id_ = log_.create_session("an unused record").value();
    start_session();
    drive_on(7);
    EXPECT_EQ(state(), expected);
}

TEST_F(EstimatedPosesTest, MapsAndPosesAreEqualWhereverTheServerWasKilled) {
    drive_on(20);
    const State expected = state();
    const auto whole = id_;
    const Revision end = session_->snapshot()->revision;
    std::vector<Revision> kills{3, end / 3, end};
    for (const Revision announced : announcements()) { // before the announcement, and after it
        kills.push_back(announced - 1);
        kills.push_back(announced);
    }
    for (const Revision kill : kills) {
        id_ = whole;
        crash_after(kill);
        drive_on(20);
        EXPECT_EQ(state(), expected) << "killed after entry " << kill;
        EXPECT_EQ(session_->snapshot()->moving_scans, 0U);
    }
}

TEST_F(EstimatedPosesTest, AnAnnouncedCorrectionIsShownAtOnceAfterARestart) {
    drive_on(20);
    const std::string expected = digest();
    start_session();
    EXPECT_FALSE(is_outdated_);
    EXPECT_EQ(digest(), expected);
}

TEST_F(EstimatedPosesTest, OnlyChunksThatDifferGetANewRevision) {
    const auto maps_after = [&](std::size_t scans) {
        drive_on(1, scans);
        return session_->snapshot();
    };
    std::size_t corrections = 0;
    auto before = maps_after(lap().scans.size() * 3 / 4);
    for (std::size_t n = lap().scans.size() * 3 / 4; n < lap().scans.size() && corrections == 0; ++n) {
        auto after = maps_after(n + 1);
        const Revision corrected = after->scan_poses.corrected();
        corrections += corrected == before->scan_poses.corrected() ? 0 : 1;
        after->laser.visit({}, 0, [&](grid::ChunkKey key, const mapping::LaserChunk& chunk) {
            const auto* earlier = before->laser.find(key);
            if (earlier == nullptr) return;
            const bool is_same = earlier->occupancy == chunk.occupancy && earlier->himm == chunk.himm;
            EXPECT_TRUE(is_same || chunk.revision > before->revision);
            EXPECT_FALSE(is_same && chunk.revision == corrected && corrected > before->revision);
        });
        before = after;
    }
    EXPECT_EQ(corrections, 1U);
}

TEST_F(EstimatedPosesTest, AReplayJobShowsTheSamePoses) {
    drive_on(20);
    const auto maps = session_->snapshot();
    limits::MemoryBudget budget(1'000'000);
    ReplayJob job(session_->info(), {config_, {}}, maps->revision, maps->scan_poses);
    while (job.run(log_, budget)) {
    }
    ASSERT_TRUE(job.maps());
    EXPECT_EQ(testing_support::digests_of(*job.maps()), digest());
}

/// A second robot starts elsewhere, with an odometry frame of its own. When the server recognises where it is, all its
/// scans appear in the map of the first.
TEST_F(EstimatedPosesTest, RobotsThatStartAnywhereEndInOneMap) {
    const slam::Drive second = slam::drive_along(
        slam::ring_building(), std::vector<Point2>{{24.0, 21.0}, {1.0, 21.0}, {1.0, 8.0}}, {.scale = 0.98}, 2);
    drive_on(20);
    const auto alone = digest();
    const auto link = drive_on("second", second, 20, 20);
    EXPECT_EQ(link->located.back().state, LocalizationState::kUnlocated);
    EXPECT_EQ(digest(), alone) << "until it is located, its scans are in no map";
    EXPECT_FALSE(find_robot("second").pose);
    EXPECT_EQ(find_robot("second").unplaced, 20U);

    const auto later = drive_on("second", second, 20, second.scans.size());
    EXPECT_EQ(later->located.back().state, LocalizationState::kTracking);
    EXPECT_EQ(find_robot("second").unplaced, 0U) << "also the first scans are in the map";
    EXPECT_EQ(digest(), digest_with_poses_in_maps());
    const Pose2 found = compose(later->located.back().T_map_odom, second.odometry.back());
    const Pose2 truth = compose(inverse(lap().truth.front()), second.truth.back());
    EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.3);

    const State expected = state();
    const auto whole = id_;
    const Revision end = session_->snapshot()->revision;
    for (const Revision kill : {end - second.scans.size(), announcements().back() - 1, announcements().back()}) {
        id_ = whole;
        crash_after(kill);
        drive_on(20);
        drive_on("second", second, 20, second.scans.size());
        EXPECT_EQ(state(), expected) << "killed after entry " << kill;
    }
}

/// An operator says where a robot is that just stands: its one scan then is in the map, also after a restart.
TEST_F(EstimatedPosesTest, AnOperatorSaysWhereARobotIs) {
    const slam::Drive second =
        slam::drive_along(slam::ring_building(), std::vector<Point2>{{1.0, 18.0}, {1.0, 12.0}}, {}, 3);
    drive_on(20);
    drive_on("second", second, 1, 1);
    const auto relocalized = [&](const std::string& robot, const Point2& near) {
        const auto& robots = session_->snapshot()->robots;
        const auto index = std::ranges::find(robots, robot, &mapping::RobotState::name) - robots.begin();
        std::optional<Result<>> answer;
        session_->relocalize({static_cast<RobotIndex>(index), near, 5.0}, [&](const Result<>& done) { answer = done; });
        run();
        return answer.value();
    };
    const Pose2 truth = compose(inverse(lap().truth.front()), second.truth.front());
    ASSERT_TRUE(relocalized("second", {truth.x + 1.0, truth.y + 1.0}));
    const auto link = drive_on("second", second, 1, 2);
    EXPECT_EQ(link->located.back().state, LocalizationState::kTracking);
    ASSERT_TRUE(find_robot("second").pose);
    EXPECT_LT(std::hypot(find_robot("second").pose->x - truth.x, find_robot("second").pose->y - truth.y), 0.3);
    EXPECT_EQ(digest(), digest_with_poses_in_maps());
    const State expected = state();
    crash_after(session_->snapshot()->revision);
    EXPECT_EQ(state(), expected);
    EXPECT_EQ(relocalized("absent", {}).error().code, Errc::kNotFound);
    EXPECT_EQ(logged().size(), session_->snapshot()->revision);
}

TEST_F(EstimatedPosesTest, TheLogSaysWhenARobotIsLostAndFoundAgain) {
    const auto occurrences = [](const std::string& text, const std::string& words) {
        std::size_t count = 0;
        for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++count;
        return count;
    };
    slam::Drive drive = lap();
    for (std::size_t n = 200; n < 230; ++n) { // the laser is covered
        for (std::size_t k = 0; k < drive.scans[n].ranges.size(); ++k) {
            drive.scans[n].ranges[k] = static_cast<RangeMm>(300 + 97 * (k * k + n) % 400);
        }
    }
    const testing_support::CapturedLog log;
    drive_on("robot", drive, 20, 230);
    EXPECT_EQ(find_robot("robot").localization.state, LocalizationState::kLost);
    EXPECT_EQ(occurrences(log.text(), "'robot' is lost"), 1U);
    EXPECT_EQ(occurrences(log.text(), "found again"), 0U);
    drive_on("robot", drive, 20, drive.scans.size());
    EXPECT_EQ(find_robot("robot").localization.state, LocalizationState::kTracking);
    EXPECT_EQ(occurrences(log.text(), "'robot' is lost"), 1U);
    EXPECT_EQ(occurrences(log.text(), "'robot' is found again"), 1U);
}

TEST_F(EstimatedPosesTest, TheMemoryOfKeyframesIsTakenAndThatOfACorrectionGivenBack) {
    const auto budget = std::make_shared<limits::MemoryBudget>(1'000'000);
    limits_.shared = {budget};
    start_session();
    drive_on(20);
    const auto recovered = recover(log_, id_, config_, false).value();
    const auto keyframes = recovered.maps.poses().graph().keyframes.size();
    EXPECT_GE(budget->used(), static_cast<std::int64_t>(recovered.maps.projection().page_count() + keyframes));
    EXPECT_EQ(budget->used(), static_cast<std::int64_t>(recovered.maps.page_count()));
}

} // namespace
} // namespace scanloom::sessions

#include "server/sessions/summary.hpp"
#include "tests/unit/server/sessions/estimated_poses_fixture.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>

namespace scanloom::sessions {
namespace {

using testing::HasSubstr;

/// A session whose map does not change while robots drive in it.
class LocalizeOnlyTest : public EstimatedPosesTest {
protected:
    Result<> change_mode(bool is_localize_only) {
        std::optional<Result<>> answer;
        session_->change_mode({is_localize_only}, [&](const Result<>& done) { answer = done; });
        run();
        return answer.value();
    }

    /// Returns how far the robot is from where it truly is, metres. @param scan  its newest one of the lap
    [[nodiscard]] double error_of(const std::string& robot, std::size_t scan) {
        const Pose2 truth = compose(inverse(lap().truth.front()), lap().truth[scan]);
        const Pose2 pose = find_robot(robot).pose.value();
        return std::hypot(pose.x - truth.x, pose.y - truth.y);
    }

    /// Returns the lap with the true poses instead of the odometry.
    [[nodiscard]] static slam::Drive exact_lap() {
        slam::Drive exact = lap();
        for (std::size_t n = 0; n < exact.truth.size(); ++n) {
            exact.odometry[n] = compose(inverse(exact.truth.front()), exact.truth[n]);
        }
        return exact;
    }
};

TEST_F(LocalizeOnlyTest, RobotsAreTrackedAndTheMapStaysAsItIs) {
    const std::size_t half = lap().scans.size() * 85 / 100; // a lap
    drive_on(20, half);
    ASSERT_TRUE(change_mode(true));
    EXPECT_TRUE(session_->snapshot()->is_localize_only);
    const std::string map = digest();
    const auto link = drive_on(20);
    EXPECT_EQ(digest(), map);
    EXPECT_EQ(link->located.back().state, LocalizationState::kTracking);
    EXPECT_LT(error_of("robot", lap().scans.size() - 1), 0.3);
    EXPECT_EQ(find_robot("robot").scan_count, lap().scans.size()) << "the trajectory has all scans";
    EXPECT_EQ(state().poses.size(), lap().scans.size());
    EXPECT_EQ(session_->snapshot()->moving_scans, 0U);

    const State expected = state();
    const auto whole = id_;
    const Revision end = session_->snapshot()->revision;
    for (const Revision kill : {half, end - 100, end}) {
        id_ = whole;
        crash_after(kill);
        if (kill == half) { // before the change
            drive_on(20, half);
            ASSERT_TRUE(change_mode(true));
        }
        EXPECT_TRUE(session_->snapshot()->is_localize_only) << "killed after entry " << kill;
        drive_on(20);
        EXPECT_EQ(state(), expected) << "killed after entry " << kill;
    }
}

TEST_F(LocalizeOnlyTest, MappingGoesOnAfterwards) {
    const std::size_t third = lap().scans.size() / 3;
    drive_on(20, third);
    ASSERT_TRUE(change_mode(true));
    drive_on(20, third + 10);
    const std::string map = digest();
    ASSERT_TRUE(change_mode(false));
    EXPECT_EQ(digest(), map);
    drive_on(20);
    EXPECT_NE(digest(), map);
    EXPECT_EQ(digest(), digest_with_poses_in_maps()) << "without the scans of localize-only mode";
    EXPECT_LT(error_of("robot", lap().scans.size() - 1), 0.3);
    const auto revision = session_->snapshot()->revision;
    ASSERT_TRUE(change_mode(false));
    EXPECT_EQ(session_->snapshot()->revision, revision) << "it was so already";
}

/// The map was made by a robot that sends its poses. Others, whose poses the server estimates, are located in it.
TEST_F(LocalizeOnlyTest, RobotsOfAllKindsOfPosesJoin) {
    const slam::Drive exact = exact_lap();
    const std::size_t length = exact.scans.size();
    drive_on("given", exact, 20, length - 20, Poses::kMap);
    ASSERT_TRUE(change_mode(true));
    const std::string map = digest();
    drive_on("given", exact, 20, length, Poses::kMap);
    EXPECT_LT(error_of("given", length - 1), 1e-9);
    const auto link = drive_on("estimated", lap(), 20, length / 2);
    EXPECT_EQ(link->located.back().state, LocalizationState::kTracking);
    EXPECT_LT(error_of("estimated", length / 2 - 1), 0.15);
    EXPECT_EQ(digest(), map);
    ASSERT_TRUE(change_mode(false)) << "the frame is that of the poses that are sent";
    drive_on("estimated", lap(), 20, length);
    EXPECT_NE(digest(), map);
    EXPECT_EQ(digest(), digest_with_poses_in_maps());
    EXPECT_LT(error_of("estimated", length - 1), 0.15);

    const State expected = state();
    start_session();
    EXPECT_EQ(state(), expected);
}

/// Both came when there was no map. The frame is then that of the robot that sends its poses.
TEST_F(LocalizeOnlyTest, ARobotThatCameBeforeTheMapIsLocatedInThatOfAnotherOne) {
    const slam::Drive exact = exact_lap();
    const std::size_t length = exact.scans.size();
    ASSERT_TRUE(change_mode(true));
    drive_on("estimated", lap(), 20, 40);
    drive_on("given", exact, 20, 40, Poses::kMap);
    ASSERT_TRUE(change_mode(false));
    drive_on("estimated", lap(), 20, 60);
    EXPECT_EQ(find_robot("estimated").localization.state, LocalizationState::kUnlocated) << "nothing is mapped yet";
    drive_on("given", exact, 20, length, Poses::kMap);
    drive_on("estimated", lap(), 20, length / 2);
    EXPECT_EQ(find_robot("estimated").localization.state, LocalizationState::kTracking);
    EXPECT_LT(error_of("estimated", length / 2 - 1), 0.15);
    const State expected = state();
    start_session();
    EXPECT_EQ(state(), expected);
}

TEST_F(LocalizeOnlyTest, MappingDoesNotGoOnWithPosesInAnotherFrame) {
    drive_on(20, 40);
    ASSERT_TRUE(change_mode(true));
    drive_on("given", lap(), 20, 40, Poses::kMap);
    const auto refused = change_mode(false);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kConflict);
    EXPECT_THAT(refused.error().message, HasSubstr("robot 'given', which sends its poses"));
}

TEST_F(LocalizeOnlyTest, ARobotThatCameBeforeTheMapBeginsItAfterwards) {
    ASSERT_TRUE(change_mode(true));
    const std::string empty = digest();
    const auto link = drive_on(20, 80);
    EXPECT_EQ(link->located.back().state, LocalizationState::kUnlocated);
    EXPECT_EQ(digest(), empty);
    ASSERT_TRUE(change_mode(false));
    drive_on(20, 200);
    EXPECT_NE(digest(), empty);
    EXPECT_EQ(digest(), digest_with_poses_in_maps());
    const State expected = state();
    start_session();
    EXPECT_EQ(state(), expected);
}

TEST_F(LocalizeOnlyTest, AFullMapStillLocatesRobots) {
    drive_on(20, 40, Poses::kMap);
    limits_.chunks_max = session_->snapshot()->chunk_count;
    start_session();
    ASSERT_TRUE(change_mode(true));
    drive_on(20, 200, Poses::kMap);
    EXPECT_EQ(find_robot("robot").last_seq, 200U);
}

TEST_F(LocalizeOnlyTest, ARobotWithoutScansDoesNotKeepTheMode) {
    drive_on(20, 40);
    ASSERT_TRUE(change_mode(true));
    session_->join({"mistaken", {}, {}, Poses::kMap}, std::make_shared<LocatedLink>(), [](const auto&) {});
    run();
    EXPECT_TRUE(change_mode(false));
    EXPECT_FALSE(session_->snapshot()->is_localize_only);
}

TEST_F(LocalizeOnlyTest, ACheckpointKeepsTheMode) {
    drive_on(20, 40, Poses::kMap);
    ASSERT_TRUE(change_mode(true));
    const std::string map = digest();
    bool is_closed = false;
    session_->close({Errc::kShuttingDown, "closed"}, [&] { is_closed = true; });
    run();
    ASSERT_TRUE(is_closed);
    EXPECT_TRUE(summary_of(*session_->snapshot()).facts->is_localize_only);
    EXPECT_TRUE(read_summary(log_, id_, config_).value().value().facts->is_localize_only);
    start_session();
    EXPECT_TRUE(session_->snapshot()->is_localize_only);
    EXPECT_EQ(digest(), map);
    drive_on(20, 60, Poses::kMap);
    EXPECT_EQ(digest(), map);
}

} // namespace
} // namespace scanloom::sessions

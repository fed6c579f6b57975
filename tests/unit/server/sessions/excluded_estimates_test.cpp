#include "server/sessions/replay_job.hpp"
#include "server/sessions/session_check.hpp"
#include "tests/unit/core/slam/carried_drive.hpp"
#include "tests/unit/server/sessions/estimated_poses_fixture.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

/// Estimated poses and maps of a session with excluded scans equal those of a session without these scans.
namespace scanloom::sessions {
namespace {

using slam::carried_drive;
using slam::kBack;
using slam::kCarried;

constexpr SeqRange kElsewhere{kCarried, kBack - 1};

/// Returns the drive of a robot that was not in the other building.
slam::Drive drive_without() {
    slam::Drive drive = carried_drive();
    const auto cut = [](auto& list) { list.erase(list.begin() + (kCarried - 1), list.begin() + (kBack - 1)); };
    cut(drive.scans);
    cut(drive.odometry);
    return drive;
}

class ExcludedEstimatesTest : public EstimatedPosesTest {
protected:
    /// Returns the state of a session that never had the excluded scans.
    /// @param end  number of scans with the excluded ones
    [[nodiscard]] State state_without(Poses poses, std::size_t end) {
        const auto drive = drive_without();
        drive_on("robot", drive, 20, end - (kBack - kCarried), poses);
        EXPECT_EQ(session_->snapshot()->moving_scans, 0U);
        State never = state();
        unplaced_ = find_robot("robot").unplaced;
        id_ = log_.create_session(kRecord).value();
        start_session();
        return never;
    }

    /// Closes the session, which writes a checkpoint, and loads it.
    void restart() {
        close();
        load();
    }

    /// Appends the entry to the log of the closed session, as the registry does, and loads it.
    void restart_with(const LogEntry& entry) {
        close();
        const auto end = log_.end_of(id_).value();
        ASSERT_TRUE(store::append_and_wait(log_, id_, end + 1, {wire::encode_entry(entry)}));
        load();
    }

    /// Compares the poses and maps of the whole log with those of the checkpoint.
    void expect_that_the_checkpoint_is_right() {
        close();
        const auto stored = log_.sessions().value();
        const auto one = std::ranges::find(stored, id_, &store::StoredSession::id);
        const auto checked = check_session(log_, *one, CheckDepth::kMaps, [](std::size_t) { return Result<>(); });
        EXPECT_EQ(checked.value().damage, std::nullopt);
        load();
    }

    std::uint64_t unplaced_ = 0; // scans of state_without()
    static inline const std::string kRecord = wire::encode_session({"lab", 0.0, mapping::options_of({})});

private:
    void close() {
        bool is_closed = false;
        session_->close({Errc::kShuttingDown, "closed"}, [&] { is_closed = true; });
        run();
        ASSERT_TRUE(is_closed);
    }

    void load() {
        start_session();
        if (is_outdated_) session_->correct_maps();
        run();
    }
};

class ExcludedEstimatesOfEachKindTest : public ExcludedEstimatesTest, public testing::WithParamInterface<Poses> {};

TEST_P(ExcludedEstimatesOfEachKindTest, LeaveNoTraceUntilTheExclusionIsLifted) {
    constexpr std::size_t kEnd = kBack + 120;
    const State never = state_without(GetParam(), kEnd);
    drive_on("robot", carried_drive(), 20, kEnd, GetParam());
    const State before = state();
    EXPECT_NE(before.poses, never.poses);
    restart_with(ScansExcluded{1, 0, kElsewhere});
    EXPECT_EQ(state(), never);
    EXPECT_EQ(find_robot("robot").excluded, kBack - kCarried);
    EXPECT_EQ(find_robot("robot").unplaced, unplaced_);
    restart(); // from a checkpoint
    EXPECT_EQ(state(), never);
    expect_that_the_checkpoint_is_right();
    restart_with(ExclusionLifted{1});
    EXPECT_EQ(state(), before);
    expect_that_the_checkpoint_is_right();
}

TEST_P(ExcludedEstimatesOfEachKindTest, LeaveNoTraceInLaterScans) {
    const State never = state_without(GetParam(), carried_drive().scans.size());
    drive_on("robot", carried_drive(), 20, kBack + 30, GetParam());
    restart_with(ScansExcluded{1, 0, kElsewhere});
    drive_on("robot", carried_drive(), 20, carried_drive().scans.size() - 100, GetParam());
    restart();
    drive_on("robot", carried_drive(), 20, carried_drive().scans.size(), GetParam());
    EXPECT_EQ(state(), never);
    expect_that_the_checkpoint_is_right();
}

INSTANTIATE_TEST_SUITE_P(WithoutOdometry, ExcludedEstimatesOfEachKindTest, testing::Values(Poses::kNone));
INSTANTIATE_TEST_SUITE_P(WithOdometryTrials, ExcludedEstimatesOfEachKindTest, testing::Values(Poses::kOdometry));

TEST_F(ExcludedEstimatesTest, ReplayJobsShowThePosesAfterAnExclusion) {
    drive_on("robot", carried_drive(), 20, kBack + 100);
    const auto before = session_->snapshot();
    const Revision until = kBack + 50;
    limits::MemoryBudget budget(1'000'000);
    const auto finish = [&](ReplayJob& job) {
        while (job.run(log_, budget)) {
        }
        ASSERT_TRUE(job.maps());
    };
    const SessionInfo info = session_->info();
    ReplayJob newest(info, {config_, {}}, before->revision, before->scan_poses);
    ReplayJob earlier(info, {config_, {.revision = until}}, until, before->scan_poses);
    for (ReplayJob* job : {&newest, &earlier}) finish(*job);

    restart_with(ScansExcluded{1, 0, SeqRange{20, kBack - 1}}); // scans of the map, too
    const auto after = session_->snapshot();
    EXPECT_GT(after->scan_poses.version(), before->scan_poses.version());
    SessionInfo changed = info;
    changed.exclusions = after->exclusions;
    ReplayJob expected(changed, {config_, {.revision = until}}, until, after->scan_poses);
    EXPECT_FALSE(earlier.base_for(expected, until)) << "its scans are elsewhere";
    finish(expected);
    EXPECT_NE(testing_support::digests_of(*expected.maps()), testing_support::digests_of(*earlier.maps()));
    for (const auto& [job, target] : {std::pair(&newest, after->revision), std::pair(&earlier, until)}) {
        ASSERT_FALSE(job->join(target, after->scan_poses));
        EXPECT_FALSE(job->maps_with(target)) << "not the maps before the exclusion";
        ASSERT_TRUE(job->resume(target, budget));
        finish(*job);
        EXPECT_TRUE(job->maps_with(target));
    }
    EXPECT_EQ(testing_support::digests_of(*newest.maps()), digest());
    EXPECT_EQ(testing_support::digests_of(*earlier.maps()), testing_support::digests_of(*expected.maps()));
}

/// Poses change while a job is running.
TEST_F(ExcludedEstimatesTest, AReplayJobThatRunsTakesThePosesAfterAnExclusion) {
    drive_on("robot", carried_drive(), 20, kBack + 100);
    const auto before = session_->snapshot();
    const Revision until = kBack + 50;
    limits::MemoryBudget budget(1'000'000);
    ReplayJob job(session_->info(), {config_, {.revision = until}}, until, before->scan_poses);
    ASSERT_TRUE(job.run(log_, budget, 1.0)); // a turn
    restart_with(ScansExcluded{1, 0, kElsewhere});
    const auto poses = session_->snapshot()->scan_poses;
    EXPECT_TRUE(job.join(until, poses));
    while (job.run(log_, budget)) {
    }
    ReplayJob expected(session_->info(), {config_, {.revision = until}}, until, poses);
    while (expected.run(log_, budget)) {
    }
    ASSERT_TRUE(job.maps_with(until));
    EXPECT_EQ(testing_support::digests_of(*job.maps()), testing_support::digests_of(*expected.maps()));
}

} // namespace
} // namespace scanloom::sessions

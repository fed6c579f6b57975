#include "server/sessions/log_readers.hpp"
#include "server/sessions/stored_trajectories.hpp"
#include "tests/unit/server/sessions/session_fixture.hpp"

#include <random>

/// With max_jump, the maps of a session equal those of a session without the omitted scans.
namespace scanloom::sessions {
namespace {

constexpr double kMaxJump = 1.0;

/// Returns the scans of a robot that walks, whose poses are sometimes wrong, and that is sometimes carried elsewhere.
std::vector<Scan> walk(unsigned seed, std::size_t count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> step(-0.6, 0.6);
    auto scans = random_scans(seed, 1, count);
    Point2 place{step(random), step(random)};
    for (auto& scan : scans) {
        place += {step(random), step(random)};
        if (random() % 20 == 0) place += {30.0 * step(random), 3.0}; // the robot is carried
        const bool is_wrong = random() % 6 == 0;
        scan.pose->x = place.x + (is_wrong ? 50.0 * step(random) : 0.0);
        scan.pose->y = place.y + (is_wrong ? 20.0 : 0.0);
    }
    return scans;
}

/// Decides by the definition, from the whole log each time.
bool is_left_out(const std::vector<Scan>& scans, std::size_t n) {
    const auto distance = [&](std::size_t to) {
        return std::hypot(scans[n].pose->x - scans[to].pose->x, scans[n].pose->y - scans[to].pose->y);
    };
    if (n == 0 || distance(n - 1) <= kMaxJump) return false;
    std::size_t integrated = n - 1;
    while (is_left_out(scans, integrated)) --integrated; // the first scan is never omitted
    return distance(integrated) > kMaxJump;
}

std::vector<Scan> without_jumps(const std::vector<Scan>& scans) {
    std::vector<Scan> kept;
    for (std::size_t n = 0; n < scans.size(); ++n) {
        if (is_left_out(scans, n)) continue;
        kept.push_back(scans[n]);
        kept.back().seq = kept.size();
    }
    return kept;
}

class JumpsTest : public SessionTest {
protected:
    void SetUp() override {
        config_.max_jump = kMaxJump;
        SessionTest::SetUp();
    }

    /// Streams both robots' scans in turn, `each` scans at a time. In between, the session is closed or crashes, and
    /// starts again.
    void stream(const std::vector<std::vector<Scan>>& walks, std::size_t each) {
        for (std::size_t begin = 0; begin < walks[0].size(); begin += each) {
            for (std::size_t robot = 0; robot < walks.size(); ++robot) {
                const auto first = walks[robot].begin() + static_cast<std::ptrdiff_t>(begin);
                session_->submit(join(robot == 0 ? "a" : "b"),
                                 std::vector<Scan>(first, first + static_cast<std::ptrdiff_t>(each)), 10);
                run();
            }
            if (begin / each % 3 == 0) session_->close({Errc::kShuttingDown, "bye"}, [] {}); // writes a checkpoint
            run();
            session_.reset();
            start_session();
        }
    }

    /// Returns the log of a session without the jumps.
    [[nodiscard]] std::vector<LogEntry> log_without_jumps(const std::vector<std::vector<Scan>>& walks) const {
        std::vector<LogEntry> log;
        for (RobotIndex robot = 0; robot < walks.size(); ++robot) {
            log.push_back(RobotJoined{robot, robot == 0 ? "a" : "b"});
            log.push_back(SensorDescribed{robot, small_laser()});
            for (const Scan& scan : without_jumps(walks[robot])) log.push_back(ScanTaken{robot, scan});
        }
        return log;
    }
};

TEST_F(JumpsTest, MapsAndTrajectoriesEqualThoseWithoutJumps) {
    const std::vector<std::vector<Scan>> walks = {walk(1, 240), walk(2, 240)};
    stream(walks, 20);
    mapping::Projection expected{mapping::MapConfig{}};
    for (const auto& entry : log_without_jumps(walks)) ASSERT_TRUE(expected.apply(entry));
    const auto maps = session_->snapshot();
    const auto wanted = expected.snapshot();
    EXPECT_EQ(maps->bounds, wanted.bounds);
    std::uint64_t jumps = 0;
    const auto old = read_old_paths(log_, id_, *maps, 0, [] { return true; }).value();
    for (RobotIndex robot = 0; robot < 2; ++robot) {
        const auto& actual = maps->robots[robot];
        const auto& wanted_robot = wanted.robots[robot];
        EXPECT_EQ(actual.last_seq, 240U);
        EXPECT_EQ(actual.scan_count, wanted_robot.scan_count);
        EXPECT_EQ(actual.jumps, 240U - wanted_robot.scan_count);
        EXPECT_EQ(std::tie(actual.stamp, actual.pose), std::tie(wanted_robot.stamp, wanted_robot.pose));
        jumps += actual.jumps;
        ASSERT_EQ(actual.trajectory.size(), wanted_robot.trajectory.size());
        for (std::size_t n = 0; n < wanted_robot.trajectory.size(); ++n) {
            const auto& point = n < actual.trajectory.begin() ? old.robots[robot][n] : actual.trajectory[n];
            ASSERT_EQ(point.pose, wanted_robot.trajectory[n].pose) << robot << ", " << n;
        }
    }
    EXPECT_GT(jumps, 40U);
    EXPECT_EQ(counters_->scans_jumped, jumps);
    EXPECT_EQ(counters_->scans_applied, 480U - jumps);
}

TEST_F(JumpsTest, CellsOfOneRobotAreBitwiseEqual) {
    const std::vector<std::vector<Scan>> walks = {walk(3, 120)};
    stream(walks, 8);
    mapping::Projection expected{mapping::MapConfig{}};
    for (const auto& entry : log_without_jumps(walks)) ASSERT_TRUE(expected.apply(entry));
    EXPECT_EQ(digest(), testing_support::digests_of(expected.snapshot()));
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(JumpsTest, TrajectoriesReadFromAnyRevisionAreEqual) {
    stream({walk(4, 120)}, 30);
    const auto maps = session_->snapshot();
    const auto whole = read_old_paths(log_, id_, *maps, 0, [] { return true; }).value().robots[0];
    for (Revision since = 0; since < maps->revision; since += 7) {
        const auto part = read_old_paths(log_, id_, *maps, since, [] { return true; }).value().robots[0];
        const auto beyond = std::ranges::upper_bound(whole, since, {}, &mapping::TrajectoryPoint::revision);
        ASSERT_EQ(part, std::vector(beyond, whole.end())) << since;
    }
}

TEST_F(JumpsTest, CapturesContainNoJumps) {
    const std::vector<std::vector<Scan>> walks = {walk(5, 200)};
    stream(walks, 50);
    landmarks::SessionCaptures expected;
    std::vector<landmarks::Capture> wanted;
    for (const auto& entry : log_without_jumps(walks)) {
        if (const auto ended = expected.add(entry)) wanted.push_back(ended->capture);
    }
    landmarks::SessionCaptures captures{ScanFilter(kMaxJump)};
    std::size_t n = 0;
    const auto visit = [&](const landmarks::RobotCapture& ended) -> Result<> {
        if (n >= wanted.size()) return Error{Errc::kInternal, "a capture more than expected"};
        EXPECT_EQ(ended.capture.points, wanted[n].points) << n;
        ++n;
        return {};
    };
    ASSERT_TRUE(read_captures(log_, id_, captures, session_->snapshot()->revision, {}, visit,
                              [](Revision) { return Result<>(); }));
    EXPECT_EQ(n, wanted.size());
    EXPECT_GT(n, 5U);
}

TEST_F(JumpsTest, AllScansAreIntegratedWithoutMaxJump) {
    config_.max_jump = 0.0;
    session_.reset();
    start_session();
    stream({walk(6, 40)}, 40);
    EXPECT_EQ(session_->snapshot()->robots[0].scan_count, 40U);
    EXPECT_EQ(session_->snapshot()->robots[0].jumps, 0U);
}

} // namespace
} // namespace scanloom::sessions

#include "server/sessions/stored_trajectories.hpp"

#include "tests/unit/server/sessions/session_fixture.hpp"

#include <optional>
#include <random>

/// The points read from the log and the points kept in memory together form every robot's whole trajectory.
namespace scanloom::sessions {
namespace {

using testing::HasSubstr;
using Path = std::vector<mapping::TrajectoryPoint>;

const auto kWanted = [] { return true; };

/// Robot 0 scans often, robot 1 rarely, robot 2 never.
class OldPathsTest : public testing::Test {
protected:
    void SetUp() override {
        id_ = log_.create_session("s").value();
        add(RobotJoined{0, "a"});
        add(SensorDescribed{0, small_laser()});
        add(RobotJoined{1, "b"});
        add(SensorDescribed{1, small_laser()});
        add(RobotJoined{2, "c"});
    }

    void add(const LogEntry& entry) {
        ASSERT_TRUE(store::append_and_wait(log_, id_, ++end_, {wire::encode_entry(entry)}));
        ASSERT_TRUE(projection_->apply(entry));
    }

    void scan(std::size_t count) {
        for (std::size_t n = 0; n < count; ++n) {
            const RobotIndex robot = random_() % 10 == 0 ? 1 : 0;
            Scan scan;
            scan.seq = paths_[robot].size() + 1;
            scan.stamp = static_cast<double>(end_) / 8;
            scan.sensor = small_laser().id;
            scan.pose = {static_cast<double>(n % 100) / 10, 0.5, 0.125};
            scan.ranges = {kInvalidRange};
            scan.angles = ExplicitAngles{0.0};
            add(ScanTaken{robot, scan});
            paths_[robot].push_back({end_, scan.stamp, *scan.pose});
        }
    }

    /// Simulates a restart: no points are kept in memory.
    void restart() {
        const auto state = projection_->state();
        projection_.emplace(mapping::MapConfig{}).restore(state);
    }

    void expect_whole_paths(Revision since, std::size_t points_max = kTrajectoryPointsMax) {
        const auto maps = projection_->snapshot();
        std::vector<Path> read(3);
        std::size_t answers = 0;
        Revision from = since;
        do {
            const auto old = read_old_paths(log_, id_, maps, from, kWanted, points_max);
            ASSERT_TRUE(old) << old.error().message;
            std::size_t points = 0;
            std::size_t all_points = 0;
            for (RobotIndex robot = 0; robot < 3; ++robot) {
                const auto& path = maps.robots[robot].trajectory;
                read[robot].insert(read[robot].end(), old->robots[robot].begin(), old->robots[robot].end());
                points += old->robots[robot].size();
                for (auto n = path.first_after(from); n < path.first_after(old->until); ++n) {
                    read[robot].push_back(path[n]);
                    ++all_points;
                }
            }
            all_points += points;
            ASSERT_LE(points, count_old_points(maps, from));
            ASSERT_LE(all_points, points_max);
            if (old->until < maps.revision) {
                ASSERT_EQ(all_points, points_max) << "the answer must contain as many points as allowed";
            }
            ASSERT_TRUE(old->until > from || maps.revision <= from) << "each answer must make progress";
            from = old->until;
            ++answers;
        } while (from < maps.revision);
        for (RobotIndex robot = 0; robot < 3; ++robot) {
            Path whole;
            for (const auto& point : paths_[robot]) {
                if (point.revision > since) whole.push_back(point);
            }
            ASSERT_EQ(read[robot], whole) << "robot " << robot << " after " << since << " in " << answers;
        }
    }

    void expect_whole_paths_after_some() {
        for (const Revision since : {Revision{0}, Revision{6}, end_ / 3, end_ / 2, end_ - 2, end_}) {
            expect_whole_paths(since);
            expect_whole_paths(since, 1000);
            expect_whole_paths(since, 999);
            expect_whole_paths(since, 7000);
        }
    }

    store::MemoryScanLog log_;
    store::SessionId id_ = 0;
    Revision end_ = 0;
    std::optional<mapping::Projection> projection_{std::in_place, mapping::MapConfig{}};
    std::vector<Path> paths_{3};
    std::mt19937 random_{7};
};

TEST_F(OldPathsTest, ReadsNothingIfAllPointsAreKept) {
    scan(2000);
    EXPECT_EQ(count_old_points(projection_->snapshot(), 0), 0U);
    expect_whole_paths_after_some();
}

TEST_F(OldPathsTest, ReadsTheFirstPartOfALongTrajectory) {
    scan(2 * mapping::kTrajectoryKept);
    ASSERT_GT(projection_->snapshot().robots[0].trajectory.begin(), 0U)
        << "the test needs points that are only in the log";
    ASSERT_EQ(projection_->snapshot().robots[1].trajectory.begin(), 0U);
    expect_whole_paths_after_some();
}

TEST_F(OldPathsTest, ReadsAllPointsAfterARestart) {
    scan(3000);
    restart();
    expect_whole_paths_after_some();
    scan(3000);
    expect_whole_paths_after_some();
}

TEST_F(OldPathsTest, DoesNotReadBeyondARobotsLastScan) {
    scan(3000);
    restart();
    const Revision gone = end_;
    add(RobotJoined{3, "d"});
    EXPECT_EQ(count_old_points(projection_->snapshot(), gone), 0U);
    EXPECT_LE(count_old_points(projection_->snapshot(), gone - 100), 2 * 100U) << "at most the points of both robots";
}

TEST_F(OldPathsTest, StopsWhenTheCallbackReturnsFalse) {
    scan(5000);
    restart();
    Revision calls = 0;
    const auto old = read_old_paths(log_, id_, projection_->snapshot(), 0, [&] { return ++calls < 2; });
    ASSERT_FALSE(old);
    EXPECT_EQ(old.error().code, Errc::kShuttingDown);
    EXPECT_EQ(calls, 2U);
}

TEST_F(OldPathsTest, ReportsADamagedEntryByItsNumber) {
    scan(10);
    ASSERT_TRUE(store::append_and_wait(log_, id_, ++end_, {"\xff"}));
    restart();
    auto maps = projection_->snapshot();
    auto& path = maps.robots[0].trajectory;
    mapping::Trajectory later(path.size());
    later.append({end_ + 1, 0.0, {}});
    path = later.snapshot();
    const auto old = read_old_paths(log_, id_, maps, 0, kWanted);
    ASSERT_FALSE(old);
    EXPECT_EQ(old.error().code, Errc::kDataLoss);
    EXPECT_THAT(old.error().message, HasSubstr("log entry 16"));
}

} // namespace
} // namespace scanloom::sessions

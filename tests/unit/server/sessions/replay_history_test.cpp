#include "tests/unit/server/sessions/replay_fixture.hpp"

namespace scanloom::sessions {
namespace {

Sensor sonar_ring(std::uint32_t id, double range_max) {
    Sensor sensor;
    sensor.id = id;
    sensor.name = "ring";
    sensor.kind = SensorKind::kSonar;
    sensor.angles = UniformAngles{-1.0, 0.5, 5};
    sensor.range_max = range_max;
    return sensor;
}

/// Replay jobs of a session's past at several revisions: a log of two robots with lasers and sonars that join and
/// describe their sensors repeatedly while the other robot drives.
class ReplayHistoryTest : public ReplayFixture {
protected:
    ReplayHistoryTest() {
        entries_.clear();
        entries_.emplace_back(RobotJoined{0, "a"});
        entries_.emplace_back(SensorDescribed{0, testing_support::small_laser()});
        add_scans(0, 1, 6);
        entries_.emplace_back(RobotJoined{1, "b"});
        entries_.emplace_back(SensorDescribed{0, sonar_ring(7, 3.0)});
        add_scans(0, 7, 12);
        entries_.emplace_back(SensorDescribed{1, testing_support::small_laser()});
        add_scans(1, 1, 6);
        Sensor turned = testing_support::small_laser();
        turned.mount = {0.2, -0.1, 1.0};
        entries_.emplace_back(SensorDescribed{1, turned});
        add_scans(0, 13, 18);
        add_scans(1, 7, 12);
        append_all();
    }

    [[nodiscard]] static ReplayRequest until(Revision revision, const SessionOptions& options = {}) {
        return request(options, {revision, std::nullopt});
    }

    [[nodiscard]] Revision last() const { return entries_.size(); }

    [[nodiscard]] int entries_read() const {
        int all = 0;
        for (const int count : log_.taken()) all += count;
        return all;
    }

private:
    /// Every third scan is of the ring, once the ring is described.
    void add_scans(RobotIndex robot, std::uint64_t first, std::uint64_t last) {
        for (std::uint64_t seq = first; seq <= last; ++seq) {
            Scan scan = testing_support::random_scan(robot + 1, seq);
            scan.stamp = 1000.0 + static_cast<double>(entries_.size());
            if (robot == 0 && seq >= 7 && seq % 3 == 0) {
                scan.sensor = 7;
                scan.ranges.resize(5);
            }
            entries_.emplace_back(ScanTaken{robot, std::move(scan)});
        }
    }
};

TEST_F(ReplayHistoryTest, StepsReadEachEntryOnceAndMatchAFullReplay) {
    const SessionOptions kinds[] = {
        {},
        {.cell_size = 0.1, .class_source = ClassSource::kHimm},
        {.cell_size = 0.1, .ray_model = RayModel::kBresenham, .hit_radius = 0.2},
        {.ray_model = RayModel::kTraversal, .accumulate = true},
    };
    for (const auto& options : kinds) {
        const int before = entries_read();
        for (Revision revision = 0; revision <= last(); ++revision) {
            const auto job = finished(until(revision, options));
            ASSERT_EQ(job->progress().state, State::kDone);
            EXPECT_EQ(job->progress().applied, revision);
            const auto maps = job->maps();
            EXPECT_EQ(maps->revision, revision);
            EXPECT_EQ(digests_of(*maps), digests_of_session(options, revision)) << "until " << revision;
        }
        EXPECT_EQ(entries_read() - before, static_cast<int>(last()));
    }
}

TEST_F(ReplayHistoryTest, RobotsAndBoundsKeepTheirRevisionWhenOthersContinue) {
    const auto early = finished(until(15))->maps();
    const auto later = finished(until(last()))->maps();
    const auto between = finished(until(25))->maps(); // starts from the first job again: a second branch
    for (const auto& [maps, entries] : {std::pair(early, 15U), std::pair(between, 25U), std::pair(later, 40U)}) {
        mapping::Projection projection{mapping::MapConfig{}};
        for (std::size_t n = 0; n < std::min<std::size_t>(entries, last()); ++n) {
            ASSERT_TRUE(projection.apply(entries_[n]));
        }
        const auto expected = projection.snapshot();
        EXPECT_EQ(maps->bounds, expected.bounds);
        EXPECT_EQ(maps->chunk_count, expected.chunk_count);
        ASSERT_EQ(maps->robots.size(), expected.robots.size());
        for (std::size_t n = 0; n < expected.robots.size(); ++n) {
            const auto& is = maps->robots[n];
            const auto& should = expected.robots[n];
            EXPECT_EQ(is.name, should.name);
            EXPECT_EQ(is.last_seq, should.last_seq);
            EXPECT_EQ(is.scan_count, should.scan_count);
            EXPECT_EQ(is.pose, should.pose);
            EXPECT_EQ(is.stamp, should.stamp);
            ASSERT_EQ(is.trajectory.size(), should.trajectory.size());
            for (std::size_t p = 0; p < is.trajectory.size(); ++p) EXPECT_EQ(is.trajectory[p], should.trajectory[p]);
        }
        EXPECT_EQ(digests_of(*maps), digests_of(expected));
    }
}

TEST_F(ReplayHistoryTest, GoingBackStartsFromTheNearestEarlierMaps) {
    for (const Revision revision : {10, 20, 30}) EXPECT_EQ(finished(until(revision))->progress().revision, revision);
    const int before = entries_read();
    EXPECT_EQ(digests_of(*finished(until(24))->maps()), digests_of_session({}, 24));
    EXPECT_EQ(entries_read() - before, 4);
    EXPECT_EQ(digests_of(*finished(until(9))->maps()), digests_of_session({}, 9));
    EXPECT_EQ(entries_read() - before, 4 + 9) << "no earlier maps are kept";
}

TEST_F(ReplayHistoryTest, ContinuesOnlyFromTheSameSettingsAndSession) {
    static_cast<void>(finished(until(20)));
    const int before = entries_read();
    EXPECT_EQ(digests_of(*finished(until(21, {.danger_radius = 0.3}))->maps()),
              digests_of_session({.danger_radius = 0.3}, 21));
    EXPECT_EQ(entries_read() - before, 21);
    auto other = session_;
    other.id = log_.create_session("other").value();
    const auto job = replay_jobs_.start(other, until(20), 0).value();
    finish(*job);
    EXPECT_EQ(job->maps()->revision, 0U) << "the log of the other session is empty";
}

TEST_F(ReplayHistoryTest, RemovingTheBaseKeepsJobsStartedFromIt) {
    const auto base = finished(until(20));
    const auto pause = log_.pause_at(25);
    const auto later = start(until(30));
    pause->wait();
    EXPECT_TRUE(replay_jobs_.remove(session_.id, base->id()));
    pause->end();
    finish(*later);
    EXPECT_EQ(later->progress().state, State::kDone);
    EXPECT_EQ(digests_of(*later->maps()), digests_of_session({}, 30));
    EXPECT_EQ(entries_read(), 30);
}

TEST_F(ReplayHistoryTest, FollowingJobIsABaseAndContinues) {
    const auto following = finished(request({}));
    EXPECT_EQ(entries_read(), static_cast<int>(last()));
    const auto before = following->maps();
    const auto fixed = finished(until(last()));
    EXPECT_EQ(entries_read(), static_cast<int>(last())) << "no entries remain to be read";
    const Revision grown = last() + 2;
    for (std::uint64_t seq = 19; seq <= 20; ++seq) {
        entries_.emplace_back(ScanTaken{0, testing_support::random_scan(1, seq)});
    }
    append_all();
    EXPECT_EQ(finished(request({})), following);
    EXPECT_EQ(digests_of(*following->maps()), digests_of_session({}, grown));
    EXPECT_EQ(digests_of(*before), digests_of_session({}, grown - 2));
    EXPECT_EQ(digests_of(*fixed->maps()), digests_of_session({}, grown - 2));
    EXPECT_EQ(following->maps()->robots[0].trajectory.size(), 20U);
    EXPECT_EQ(fixed->maps()->robots[0].trajectory.size(), 18U);
}

TEST_F(ReplayHistoryTest, StampStartsOnlyFromMapsWithoutLaterScans) {
    const auto stamp = [](double seconds) { return request({}, {std::nullopt, seconds}); };
    static_cast<void>(finished(until(10)));
    static_cast<void>(finished(until(30)));
    const int before = entries_read();
    const auto job = finished(stamp(1000.0 + 20)); // entry n + 1 has stamp 1000 + n
    EXPECT_EQ(job->maps()->revision, 21U);
    EXPECT_EQ(digests_of(*job->maps()), digests_of_session({}, 21));
    EXPECT_EQ(entries_read() - before, 11);
    EXPECT_EQ(digests_of(*finished(stamp(1000.0 + 22))->maps()), digests_of_session({}, 24));
    EXPECT_EQ(entries_read() - before, 11 + 3) << "a description precedes the next scan";
}

TEST_F(ReplayHistoryTest, JobWaitsForARunningBase) {
    const auto pause = log_.pause_at(10);
    const auto first = start(until(20));
    pause->wait();
    const auto second = start(until(30));
    const auto third = start(until(last()));
    EXPECT_EQ(second->progress().state, State::kWaiting);
    pause->end();
    for (const auto& job : {first, second, third}) finish(*job);
    EXPECT_EQ(entries_read(), static_cast<int>(last()));
    EXPECT_EQ(digests_of(*first->maps()), digests_of_session({}, 20));
    EXPECT_EQ(digests_of(*second->maps()), digests_of_session({}, 30));
    EXPECT_EQ(digests_of(*third->maps()), digests_of_session({}, last()));
}

TEST_F(ReplayHistoryTest, JobStartsAloneIfItsBaseIsCancelled) {
    const auto pause = log_.pause_at(10);
    const auto first = start(until(20));
    pause->wait();
    const auto second = start(until(30));
    EXPECT_TRUE(replay_jobs_.remove(session_.id, first->id()));
    pause->end();
    finish(*second);
    EXPECT_EQ(first->progress().state, State::kCancelled);
    EXPECT_EQ(digests_of(*second->maps()), digests_of_session({}, 30));
}

TEST_F(ReplayHistoryTest, WaitingJobIsCancelledImmediately) {
    const auto pause = log_.pause_at(10);
    const auto first = start(until(20));
    pause->wait();
    const auto second = start(until(30));
    EXPECT_TRUE(replay_jobs_.remove(session_.id, second->id()));
    EXPECT_EQ(second->progress().state, State::kCancelled);
    pause->end();
    finish(*first);
    EXPECT_EQ(finished(until(30))->maps()->revision, 30U);
}

TEST_F(ReplayHistoryTest, JobBetweenTwoTurnsIsABase) {
    limits::MemoryBudget budget(1000);
    ReplayJob far(session_, until(last()), last());
    ASSERT_TRUE(far.run(log_, budget, 1.0)); // one entry
    ASSERT_TRUE(far.run(log_, budget, 1.0));
    ASSERT_TRUE(far.run(log_, budget, 1.0));
    ReplayJob near(session_, until(10), 10);
    EXPECT_EQ(far.base_for(near, 10), 3U);
    ASSERT_TRUE(near.begin_from(far));
    while (near.run(log_, budget)) {
    }
    while (far.run(log_, budget)) {
    }
    EXPECT_EQ(digests_of(*near.maps()), digests_of_session({}, 10));
    EXPECT_EQ(digests_of(*far.maps()), digests_of_session({}, last()));
    EXPECT_FALSE(far.base_for(near, 10)) << "the job is past the revision";
    EXPECT_TRUE(budget.take(1000)) << "all chunks are returned";
}

TEST_F(ReplayHistoryTest, ChunksOfTheBaseCountImmediately) {
    limits::MemoryBudget plenty(1000);
    ReplayJob base(session_, until(20), 20);
    ASSERT_FALSE(base.run(log_, plenty));
    ReplayJob again(session_, until(21), 21);
    ASSERT_TRUE(again.begin_from(base));
    limits::MemoryBudget tight(base.maps()->chunk_count - 1);
    EXPECT_FALSE(again.run(log_, tight));
    EXPECT_EQ(again.progress().error->code, Errc::kFull);
    EXPECT_EQ(again.progress().applied, 20U) << "no entry was applied";
    EXPECT_TRUE(tight.take(static_cast<std::int64_t>(base.maps()->chunk_count) - 1)) << "all chunks are returned";
    EXPECT_EQ(digests_of(*base.maps()), digests_of_session({}, 20));
}

} // namespace
} // namespace scanloom::sessions

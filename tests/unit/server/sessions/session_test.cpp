#include "tests/unit/server/sessions/session_fixture.hpp"

/// What a session accepts from its robots, and its answers.
namespace scanloom::sessions {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

TEST_F(SessionTest, ScansAreLoggedThenIntegratedThenAcknowledged) {
    const auto link = join("r");
    session_->submit(link, random_scans(1, 1, 3), 100);
    run();
    ASSERT_THAT(logged(), SizeIs(5));
    EXPECT_EQ(logged()[1], LogEntry(SensorDescribed{0, small_laser()}));
    EXPECT_EQ(logged()[4], LogEntry(ScanTaken{0, random_scan(1, 3)}));
    EXPECT_EQ(session_->snapshot()->revision, 5U);
    EXPECT_EQ(session_->snapshot()->robots[0].last_seq, 3U);
    EXPECT_EQ(digest(), digest_of_log());
    EXPECT_EQ(link->durable_seq(), 3U);
    EXPECT_EQ(link->bytes_released, 100U);
}

TEST_F(SessionTest, ResentScansAreDroppedAndTheirCreditReleased) {
    const auto link = join("r");
    session_->submit(link, random_scans(1, 1, 4), 40);
    run();
    session_->submit(link, random_scans(1, 2, 3), 30);
    run();
    EXPECT_THAT(logged(), SizeIs(6));
    EXPECT_EQ(link->bytes_released, 70U);
    session_->submit(link, random_scans(1, 3, 4), 50); // two known scans and two new ones
    run();
    EXPECT_THAT(logged(), SizeIs(8));
    EXPECT_EQ(link->durable_seq(), 6U);
    EXPECT_EQ(link->bytes_released, 120U);
    EXPECT_THAT(link->failures, IsEmpty());
}

TEST_F(SessionTest, ScansBeforeAGapAreKept) {
    const auto link = join("r");
    auto scans = random_scans(1, 1, 5);
    scans.erase(scans.begin() + 2);
    session_->submit(link, scans, 10);
    run();
    ASSERT_THAT(link->failures, SizeIs(1));
    EXPECT_THAT(link->failures[0].message, StartsWith("scan_batch.scans[2].seq is 4, 3 is the next"));
    const auto again = begin_join("r");
    EXPECT_EQ(again.answer->value().value().last_durable_seq, 2U);
    session_->submit(again.link, random_scans(1, 3, 3), 10);
    run();
    EXPECT_EQ(again.link->durable_seq(), 5U);
    EXPECT_EQ(session_->snapshot()->robots[0].scan_count, 5U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(SessionTest, SensorWithTooManyCellsOfRangeFailsTheLink) {
    const auto link = join("r");
    Sensor sensor = small_laser();
    sensor.range_max = 1000.0;
    session_->submit(link, sensor, 10);
    run();
    ASSERT_THAT(link->failures, SizeIs(1));
    EXPECT_THAT(link->failures[0].message, StartsWith("sensor_description.range_max is 1000 metres"));
}

TEST_F(SessionTest, RepeatedSensorDescriptionIsLoggedOnlyIfChanged) {
    const auto link = join("r");
    ASSERT_THAT(logged(), SizeIs(2));
    session_->submit(link, small_laser(), 70);
    run();
    EXPECT_THAT(logged(), SizeIs(2));
    EXPECT_EQ(link->bytes_released, 70U);
    Sensor moved = small_laser();
    moved.mount.x = 0.5;
    session_->submit(link, moved, 0);
    session_->submit(link, small_laser(), 0);
    run();
    EXPECT_THAT(logged(), ElementsAre(testing::_, testing::_, LogEntry(SensorDescribed{0, moved}),
                                      LogEntry(SensorDescribed{0, small_laser()})));
}

TEST_F(SessionTest, SeveralRobotsShareOneMap) {
    std::vector<std::shared_ptr<RecordedLink>> links;
    for (const char* name : {"a", "b", "c"}) links.push_back(join(name));
    for (std::uint64_t seq = 1; seq <= 20; ++seq) {
        for (unsigned robot = 0; robot < 3; ++robot) session_->submit(links[robot], {random_scan(robot, seq)}, 10);
    }
    run();
    for (const auto& link : links) {
        EXPECT_EQ(link->durable_seq(), 20U);
        EXPECT_EQ(link->bytes_released, 200U);
    }
    const auto snapshot = session_->snapshot();
    ASSERT_THAT(snapshot->robots, SizeIs(3));
    EXPECT_EQ(snapshot->robots[1].name, "b");
    EXPECT_EQ(snapshot->robots[1].trajectory.size(), 20U);
    EXPECT_EQ(digest(), digest_of_log());
}

TEST_F(SessionTest, NewLinkReplacesTheRobotsPreviousLink) {
    const auto first = join("r");
    const auto second = join("r");
    ASSERT_THAT(first->failures, SizeIs(1));
    EXPECT_EQ(first->failures[0].code, Errc::kReplaced);
    session_->submit(first, random_scans(1, 1, 1), 10); // was still under way
    session_->leave(first);
    run();
    EXPECT_EQ(session_->snapshot()->robots[0].last_seq, 0U);
    EXPECT_TRUE(session_->is_connected(0));
    session_->submit(second, random_scans(1, 1, 1), 10);
    run();
    EXPECT_EQ(second->durable_seq(), 1U);
    EXPECT_THAT(second->failures, IsEmpty());
}

TEST_F(SessionTest, ChangedBodyRadiusIsLoggedAndTheNewestApplies) {
    const auto state = [&](std::optional<double> radius) {
        const auto join = begin_join("r", "", radius);
        EXPECT_TRUE(join.answer->has_value() && join.answer->value());
        EXPECT_EQ(session_->snapshot()->robots.at(0).body_radius, radius);
        return join.link;
    };
    auto link = state(0.2);
    session_->submit(link, small_laser(), 0);
    session_->submit(link, random_scans(1, 1, 3), 10);
    run();
    static_cast<void>(state(0.2));
    static_cast<void>(state(0.3));
    link = state(std::nullopt);
    static_cast<void>(state(0.4));
    EXPECT_THAT(link->failures, SizeIs(1)) << "the earlier link was replaced";
    const auto entries = logged();
    ASSERT_THAT(entries, SizeIs(8));
    EXPECT_EQ(entries[0], LogEntry(RobotJoined{0, "r", "", 0.2}));
    EXPECT_EQ(entries[5], LogEntry(RobotJoined{0, "r", "", 0.3}));
    EXPECT_EQ(entries[6], LogEntry(RobotJoined{0, "r", ""}));
    EXPECT_EQ(entries[7], LogEntry(RobotJoined{0, "r", "", 0.4}));
    start_session();
    EXPECT_EQ(session_->snapshot()->robots.at(0).body_radius, 0.4);
    static_cast<void>(state(0.4));
    EXPECT_THAT(logged(), SizeIs(8)) << "the radius is known from before the restart";
}

TEST_F(SessionTest, LinkThatNeverJoinedIsIgnored) {
    const auto unjoined = std::make_shared<RecordedLink>();
    session_->submit(unjoined, small_laser(), 10);
    session_->submit(unjoined, random_scans(1, 1, 1), 10);
    session_->leave(unjoined);
    run();
    EXPECT_THAT(logged(), IsEmpty());
    EXPECT_THAT(unjoined->failures, IsEmpty());
}

/// Counts change notifications.
struct CountingWatcher : Watcher {
    void on_changed() noexcept override { ++count; }
    int count = 0;
};

TEST_F(SessionTest, WatchersAreNotifiedOfMapsLinksAndCloseOnly) {
    const auto watcher = std::make_shared<CountingWatcher>();
    session_->watch(watcher);
    const auto notifications = [&] { return std::exchange(watcher->count, 0); };
    const auto link = join("r1");
    EXPECT_GT(notifications(), 0) << "a link joined";
    session_->submit(link, random_scans(1, 1, 10), 1);
    run();
    EXPECT_GT(notifications(), 0) << "the maps changed";
    session_->submit(link, random_scans(1, 1, 10), 1); // known already
    run();
    EXPECT_EQ(notifications(), 0);
    session_->leave(link);
    run();
    EXPECT_EQ(notifications(), 1) << "a link left";
    session_->close({Errc::kGone, "session 'lab' was deleted"}, [] {});
    run();
    EXPECT_GT(notifications(), 0) << "the session closed";
    EXPECT_EQ(session_->closing()->code, Errc::kGone);
}

TEST_F(SessionTest, WatchersAreHeldWeakly) {
    auto watcher = std::make_shared<CountingWatcher>();
    const std::weak_ptr<CountingWatcher> weak = watcher;
    session_->watch(watcher);
    watcher.reset();
    EXPECT_TRUE(weak.expired());
    join("r1"); // must not notify the destroyed watcher
}

TEST_F(SessionTest, SnapshotsContainTheNewestScanOfEachRobot) {
    const auto first = join("r1");
    const auto second = join("r2");
    EXPECT_EQ(session_->snapshot()->robots.at(0).newest_scan, nullptr);
    session_->submit(first, random_scans(1, 1, 10), 1);
    session_->submit(second, random_scans(2, 1, 3), 1);
    run();
    const auto snapshot = session_->snapshot();
    EXPECT_EQ(snapshot->robots.at(0).newest_scan->scan, random_scan(1, 10));
    EXPECT_EQ(snapshot->robots.at(1).newest_scan->scan, random_scan(2, 3));
    EXPECT_EQ(*snapshot->robots.at(0).newest_scan->sensor, small_laser());
    EXPECT_EQ(snapshot->robots.at(1).newest_scan->revision, snapshot->revision);
    EXPECT_EQ(digest(), digest_of_log());

    start_session();
    EXPECT_EQ(session_->snapshot()->robots.at(0).newest_scan, nullptr)
        << "the newest scan is not part of the log's projection";
}

TEST_F(SessionTest, OtherSourceUnderTheSameNameIsRefused) {
    const auto first = begin_join("r", "carmen:1");
    session_->submit(first.link, small_laser(), 0);
    session_->submit(first.link, random_scans(1, 1, 3), 10);
    run();
    const auto other = begin_join("r", "carmen:2");
    EXPECT_EQ(other.answer->value().error().code, Errc::kConflict);
    EXPECT_THAT(other.answer->value().error().message,
                HasSubstr("the 3 scans of robot 'r' in session 'lab' come from 'carmen:1', not from 'carmen:2'"));
    EXPECT_THAT(begin_join("r").answer->value().error().message, HasSubstr("not from a live robot"));
    EXPECT_THAT(first.link->failures, IsEmpty()) << "the streaming robot is not affected";
    session_->close({Errc::kShuttingDown, "bye"}, [] {});
    run();
    start_session();
    EXPECT_EQ(begin_join("r", "carmen:2").answer->value().error().code, Errc::kConflict);
    EXPECT_EQ(begin_join("r", "carmen:1").answer->value().value().last_durable_seq, 3U);
}

TEST_F(SessionTest, RobotWithoutScansMayChangeItsSource) {
    begin_join("r", "carmen:1");
    const auto second = begin_join("r", "carmen:2");
    ASSERT_TRUE(second.answer->value());
    session_->submit(second.link, small_laser(), 0);
    session_->submit(second.link, random_scans(1, 1, 3), 10);
    run();
    start_session();
    EXPECT_EQ(begin_join("r", "carmen:1").answer->value().error().code, Errc::kConflict);
    EXPECT_EQ(begin_join("r", "carmen:2").answer->value().value().last_durable_seq, 3U);
    EXPECT_THAT(session_->snapshot()->robots, SizeIs(1));
}

} // namespace
} // namespace scanloom::sessions

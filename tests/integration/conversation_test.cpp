#include "server/store/rocksdb_store.hpp"
#include "server/store/scan_log.hpp"
#include "tests/integration/ingest_fixture.hpp"
#include "tests/support/digests.hpp"
#include "tests/support/temporary_directory.hpp"

/// Robots that follow the protocol.
namespace scanloom::ingest {
namespace {

TEST_F(IngestTest, CompletesAWholeConversation) {
    auto& ingest = start();
    RobotSocket robot(port());
    robot.send(hello("r"));
    const auto welcome = robot.receive_kind<wire::Welcome>();
    EXPECT_THAT(welcome.session_id, testing::MatchesRegex("[0-9a-f]{16}"));
    EXPECT_EQ(welcome.last_durable_seq, 0U);
    EXPECT_EQ(welcome.limits, (wire::Limits{1U << 20, 4096, 1024}));
    EXPECT_EQ(welcome.credit_bytes, 2U << 20);
    robot.send(small_laser());
    stream(robot, 1, 1, 55);
    robot.send(wire::Ping{77});
    EXPECT_EQ(robot.receive_kind<wire::Pong>().nonce, 77U);
    robot.send(wire::Goodbye{"done"});
    EXPECT_FALSE(robot.receive().has_value());
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(0).scan_count, 55U);
}

/// Returns the last ack before the server closes the link regularly.
std::uint64_t acknowledged_at_the_end(RobotSocket& robot) {
    std::uint64_t durable_seq = 0;
    while (const auto message = robot.receive()) {
        if (const auto* ack = std::get_if<wire::Ack>(&*message)) durable_seq = ack->durable_seq;
        EXPECT_FALSE(std::holds_alternative<wire::LinkError>(*message));
    }
    return durable_seq;
}

TEST_F(IngestTest, ScansSentTogetherWithTheGoodbyeAreAcknowledged) {
    auto& ingest = start();
    RobotSocket robot(port());
    robot.send_bytes(frame_of(hello("r")) + frame_of(small_laser()) +
                     frame_of(wire::ScanBatch{random_scans(1, 1, 500)}) + frame_of(wire::Goodbye{"done"}));
    robot.receive_kind<wire::Welcome>();
    EXPECT_EQ(acknowledged_at_the_end(robot), 500U);
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(0).scan_count, 500U);
}

TEST_F(IngestTest, AGoodbyeWaitsForTheDiskAndLaterScansAreIgnored) {
    auto& ingest = start();
    const auto robot = welcomed(port(), hello("r"));
    robot->send(small_laser());
    stream(*robot, 1, 1, 10);
    log_.hold_completions();
    std::string more = frame_of(wire::ScanBatch{random_scans(1, 31, 10)});
    while (more.size() < std::size_t{1} << 20) wire::encode(wire::Pong{1}, more);
    robot->send_bytes(frame_of(wire::ScanBatch{random_scans(1, 11, 20)}) + frame_of(wire::Ping{1}) +
                      frame_of(wire::Goodbye{"done"}) + more);
    EXPECT_EQ(robot->receive_kind<wire::Pong>().nonce, 1U);
    EXPECT_TRUE(ingest.sessions().find("lab")->is_connected(0));
    log_.release_completions();
    EXPECT_EQ(acknowledged_at_the_end(*robot), 30U);
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(0).scan_count, 30U);
}

TEST_F(IngestTest, ScansAreInFlightUntilTheirAckIsSent) {
    auto& counters = start().counters();
    const auto robot = welcomed(port(), hello("r"));
    robot->send(small_laser());
    stream(*robot, 1, 1, 10);
    EXPECT_EQ(counters.scans_in_flight.Value(), 0.0);
    log_.hold_completions();
    robot->send_bytes(frame_of(wire::ScanBatch{random_scans(1, 11, 20)}) + frame_of(wire::Ping{1}));
    robot->receive_kind<wire::Pong>();
    EXPECT_EQ(counters.scans_in_flight.Value(), 20.0);
    EXPECT_EQ(counters.ack_seconds.family().metric.at(0).histogram.sample_count, 10U);
    log_.release_completions();
    robot->wait_for_ack(30);
    EXPECT_EQ(counters.scans_in_flight.Value(), 0.0);
    EXPECT_EQ(counters.ack_seconds.family().metric.at(0).histogram.sample_count, 30U);
}

TEST_F(IngestTest, AGoodbyeIsAnsweredWithAnErrorIfTheDiskFails) {
    start();
    const auto robot = welcomed(port(), hello("r"));
    robot->send(small_laser());
    stream(*robot, 1, 1, 10);
    log_.fail_from_next_change({Errc::kStoreFailed, "no space left"});
    robot->send_bytes(frame_of(wire::ScanBatch{random_scans(1, 11, 1)}) + frame_of(wire::Goodbye{"done"}));
    expect_refused(*robot, Errc::kStoreFailed, true, "no space left");
}

TEST_F(IngestTest, SplittingTheBytesAnywhereChangesNothing) {
    auto& ingest = start();
    std::size_t robots = 0;
    for (std::size_t split = 1;; ++split, ++robots) {
        const std::string name = "r" + std::to_string(1000 + robots);
        const std::string bytes = frame_of(hello(name)) + frame_of(small_laser()) +
                                  frame_of(wire::ScanBatch{{random_scan(1, 1)}}) + frame_of(wire::Ping{split});
        if (split == bytes.size()) break;
        RobotSocket robot(port());
        robot.send_bytes(std::string_view(bytes).substr(0, split));
        robot.send_bytes(std::string_view(bytes).substr(split));
        robot.receive_kind<wire::Welcome>();
        std::uint64_t durable_seq = 0;
        std::uint64_t nonce = 0;
        while (durable_seq == 0 || nonce == 0) {
            const auto message = robot.receive().value();
            if (const auto* ack = std::get_if<wire::Ack>(&message)) durable_seq = ack->durable_seq;
            if (const auto* pong = std::get_if<wire::Pong>(&message)) nonce = pong->nonce;
        }
        EXPECT_EQ(durable_seq, 1U);
        EXPECT_EQ(nonce, split);
    }
    EXPECT_EQ(ingest.snapshot("lab")->robots.size(), robots);
}

TEST_F(IngestTest, AcceptsOneByteAtATime) {
    start();
    RobotSocket robot(port());
    const std::string bytes =
        frame_of(hello("r")) + frame_of(small_laser()) + frame_of(wire::ScanBatch{random_scans(1, 1, 5)});
    for (const char byte : bytes) robot.send_bytes({&byte, 1});
    robot.receive_kind<wire::Welcome>();
    robot.wait_for_ack(5);
}

TEST_F(IngestTest, AReconnectContinuesAfterTheLastDurableScan) {
    auto& ingest = start();
    {
        const auto robot = welcomed(port(), hello("r"));
        robot->send(small_laser());
        stream(*robot, 1, 1, 30);
        robot->send(wire::ScanBatch{random_scans(1, 31, 10)});
        robot->finish_sending();
        while (robot->receive()) {
        }
    }
    RobotSocket robot(port());
    robot.send(hello("r"));
    EXPECT_EQ(robot.receive_kind<wire::Welcome>().last_durable_seq, 40U)
        << "scans that arrived before the end are stored";
    stream(robot, 1, 36, 60); // the first five are sent again
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(0).scan_count, 60U);
}

TEST_F(IngestTest, AReconnectReplacesADeadLink) {
    start();
    const auto first = welcomed(port(), hello("r"));
    first->send(small_laser());
    stream(*first, 1, 1, 10);
    const auto second = welcomed(port(), hello("r"));
    expect_refused(*first, Errc::kReplaced, false, "robot 'r' of session 'lab' connected again");
    stream(*second, 1, 11, 20);
}

TEST_F(IngestTest, ReceivedScansAreCountedAcrossReplacedLinksAndFaultyScans) {
    auto& ingest = start();
    const auto first = welcomed(port(), hello("r"));
    first->send(small_laser());
    stream(*first, 1, 1, 10);
    const auto second = welcomed(port(), hello("r"));
    stream(*second, 1, 6, 20); // the first five are sent again
    auto faulty = random_scans(1, 21, 10);
    faulty[3].sensor = 77;
    second->send(wire::ScanBatch{std::move(faulty)});
    EXPECT_EQ(farewell_to(*second).error.code, Errc::kInvalidField);
    const auto third = welcomed(port(), hello("r")); // after the earlier scans have been applied
    const auto& counted = ingest.sessions().counters();
    EXPECT_EQ(counted.scans_applied, 23U);
    EXPECT_EQ(counted.scans_duplicates, 5U);
    EXPECT_EQ(counted.scans_dropped, 7U);
    EXPECT_EQ(ingest.counters().scans_received.Value(), 35.0);
}

TEST_F(IngestTest, TwoRobotsShareAMapAndHaveSeparateSeqs) {
    auto& ingest = start();
    std::vector<std::thread> robots;
    for (unsigned n = 0; n < 2; ++n) {
        robots.emplace_back([&, n] {
            const auto robot = welcomed(port(), hello("r" + std::to_string(n)));
            robot->send(small_laser());
            stream(*robot, n, 1, 200);
        });
    }
    for (auto& robot : robots) robot.join();
    const auto snapshot = ingest.snapshot("lab");
    ASSERT_EQ(snapshot->robots.size(), 2U);
    EXPECT_EQ(snapshot->revision, 2U + 2U + 400U);
    for (const auto& robot : snapshot->robots) EXPECT_EQ(robot.last_seq, 200U);
}

TEST_F(IngestTest, ASecondRobotThatBeginsTheMapGetsAFinalConflict) {
    auto& ingest = start();
    const auto first = welcomed(port(), hello("first"));
    const auto late = welcomed(port(), hello("late"));
    const auto begin = [](RobotSocket& robot, unsigned seed) {
        auto scans = random_scans(seed, 1, 3);
        for (Scan& scan : scans) scan.begins_map = true;
        robot.send(small_laser());
        robot.send(wire::ScanBatch{std::move(scans)});
    };
    begin(*first, 1);
    while (first->receive_kind<wire::Ack>().durable_seq < 3) {
    }
    begin(*late, 2);
    const auto error = late->receive_kind<wire::LinkError>();
    EXPECT_EQ(error.error.code, Errc::kConflict);
    EXPECT_FALSE(error.retryable);
    EXPECT_THAT(error.error.message, testing::HasSubstr("scan_batch.scans[0].begins_map: robot 'late' was to begin"));
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(1).scan_count, 0U);
}

TEST_F(IngestTest, TenConcurrentSessionsHaveTheMapsOfSeparateRuns) {
    auto& ingest = start();
    std::vector<std::thread> robots;
    for (unsigned n = 0; n < 10; ++n) {
        robots.emplace_back([&, n] {
            const auto robot = welcomed(port(), hello("r", "s" + std::to_string(n)));
            robot->send(small_laser());
            stream(*robot, n, 1, 60);
        });
    }
    for (auto& robot : robots) robot.join();
    for (unsigned n = 0; n < 10; ++n) {
        mapping::Projection alone{mapping::MapConfig{}};
        ASSERT_TRUE(alone.apply(RobotJoined{0, "r"}));
        ASSERT_TRUE(alone.apply(SensorDescribed{0, small_laser()}));
        for (const auto& scan : random_scans(n, 1, 60)) ASSERT_TRUE(alone.apply(ScanTaken{0, scan}));
        EXPECT_EQ(ingest.digest("s" + std::to_string(n)), testing_support::digests_of(alone.snapshot()));
    }
}

TEST(IngestWithRocksDb, ARestartKeepsEverythingAndTheRobotContinues) {
    const TemporaryDirectory directory;
    std::string digest;
    {
        const auto log = store::open_rocksdb(directory.path()).value();
        RunningIngest ingest(*log);
        const auto robot = welcomed(ingest.port(), hello("r"));
        robot->send(small_laser());
        stream(*robot, 1, 1, 300);
        digest = ingest.digest("lab");
    }
    const auto log = store::open_rocksdb(directory.path()).value();
    RunningIngest ingest(*log);
    EXPECT_EQ(ingest.digest("lab"), digest);
    RobotSocket robot(ingest.port());
    robot.send(hello("r"));
    EXPECT_EQ(robot.receive_kind<wire::Welcome>().last_durable_seq, 300U);
    stream(robot, 1, 301, 350);
    EXPECT_EQ(ingest.snapshot("lab")->robots.at(0).trajectory.size(), 350U);
}

} // namespace
} // namespace scanloom::ingest

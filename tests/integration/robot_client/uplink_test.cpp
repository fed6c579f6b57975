#include "tests/integration/robot_client/uplink_fixture.hpp"

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(UplinkTest, StreamsEverythingAndSendsGoodbye) {
    serve({{}});
    const auto outcome = run(options());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_all_stored_once();
    EXPECT_EQ(server_->goodbyes(), 1);
    EXPECT_EQ(uplink_->status().acknowledged, kScans);
    EXPECT_EQ(uplink_->status().reconnects, 0U);
    EXPECT_GT(server_->largest_batch(), 1U) << "without a pace, several scans share a frame";
}

TEST_F(UplinkTest, TheServerThatHasTheSessionIsConnectedAtOnce) {
    FakeServer owner(io_, {{}});
    serve({{.refuse_hello =
                wire::LinkError{{Errc::kNotOwner, "not here"}, true, "127.0.0.1:" + std::to_string(owner.port())}}});
    auto made = options();
    made.backoff.first = 1h; // there would be no time to wait
    EXPECT_TRUE(run(made));
    EXPECT_EQ(owner.stored().size(), kScans);
    EXPECT_THAT(server_->stored(), IsEmpty());
    EXPECT_THAT(troubles_, IsEmpty());
}

TEST_F(UplinkTest, TheNextServerIsTriedWhenOneCannotBeReached) {
    serve({{}});
    auto made = options();
    made.servers.insert(made.servers.begin(), {{"127.0.0.1", "1"}, {"127.0.0.1", "2"}});
    EXPECT_TRUE(run(made));
    expect_all_stored_once();
}

TEST_F(UplinkTest, RequestsAreAnsweredBetweenScans) {
    serve({{}});
    std::vector<Point2> ends;
    const auto answered = [&](const link::Reply& reply) {
        ends.push_back(std::get<wire::PlanReply>(reply).result.value().points.back());
    };
    server_->on_stored = [&](std::size_t stored) {
        if (stored != 100 && stored != 200) return;
        const double x = static_cast<double>(stored);
        EXPECT_TRUE(uplink_->ask(wire::PlanRequest{.goal = {x, 4.0}}, answered));
    };
    EXPECT_TRUE(run(options()));
    expect_all_stored_once();
    EXPECT_THAT(ends, ElementsAre(Point2{100.0, 4.0}, Point2{200.0, 4.0}));
}

TEST_F(UplinkTest, RequestsOfABrokenLinkAreSentAgain) {
    serve({{.hang_up_after_requests = 1}, {}});
    int answers = 0;
    server_->on_stored = [&](std::size_t stored) {
        if (stored != 100 || !server_->plans().empty()) return;
        EXPECT_TRUE(uplink_->ask(wire::PlanRequest{.goal = {3.0, 4.0}}, [&](const link::Reply&) { ++answers; }));
    };
    EXPECT_TRUE(run(options()));
    expect_all_stored_once();
    EXPECT_EQ(answers, 1);
    EXPECT_EQ(server_->plans().size(), 2U);
    EXPECT_EQ(uplink_->status().reconnects, 1U);
}

TEST_F(UplinkTest, ASmallCreditOnlySlowsItDown) {
    serve({{.credit_bytes = 700}});
    EXPECT_TRUE(run(options(), 50));
    expect_all_stored_once(50);
}

TEST_F(UplinkTest, SurvivesAnyNumberOfBrokenLinks) {
    std::vector<LinkScript> scripts;
    for (const std::uint64_t scans : {1U, 50U, 51U, 120U}) scripts.push_back({.hang_up_after_scans = scans});
    scripts.push_back({.hang_up_after_scans = 33, .ack_every = 1000}); // stored, never acknowledged
    scripts.push_back({});
    serve(scripts);
    const auto outcome = run(options());
    EXPECT_TRUE(outcome) << outcome.error().message;
    expect_all_stored_once();
    EXPECT_EQ(uplink_->status().reconnects, 5U);
    EXPECT_EQ(troubles_.size(), 5U);
}

TEST_F(UplinkTest, ASilentServerCausesAReconnect) {
    serve({{.silent_after_scans = 10}, {}});
    auto made = options();
    made.protocol.ping_after = 50ms;
    made.protocol.silence_max = 200ms;
    EXPECT_TRUE(run(made));
    ASSERT_FALSE(troubles_.empty());
    EXPECT_THAT(troubles_[0], HasSubstr("nothing came from the server"));
    EXPECT_GE(uplink_->status().reconnects, 1U);
    expect_all_stored_once();
}

TEST_F(UplinkTest, AServerThatStopsReadingCausesAReconnect) {
    serve({{.stop_reading_after_scans = 10, .credit_bytes = 100 << 20}, {.credit_bytes = 100 << 20}});
    auto made = options();
    made.protocol.ping_after = 50ms;
    made.protocol.silence_max = 200ms;
    EXPECT_TRUE(run(made, 40'000)) << "more than the kernel's buffers hold, so that a write blocks";
    EXPECT_EQ(uplink_->status().acknowledged, 40'000U);
    EXPECT_GE(uplink_->status().reconnects, 1U);
}

TEST_F(UplinkTest, ANewProgramContinuesTheRecordingAfterTheLastStoredScan) {
    serve({{}});
    server_->store_before(200);
    auto made = options();
    std::vector<std::uint64_t> resumed;
    pace_.on_resume = [&](std::uint64_t stored) { resumed.push_back(stored); };
    EXPECT_TRUE(run(made));
    expect_all_stored_once(kScans, 200);
    EXPECT_EQ(uplink_->status().resumed_after, 200U);
    EXPECT_EQ(uplink_->status().sent, kScans - 200);
    EXPECT_THAT(resumed, ElementsAre(200U));
}

TEST_F(UplinkTest, ScansSentAgainCountOnceAsSent) {
    serve({{.hang_up_after_scans = 33, .ack_every = 1000}, {}});
    EXPECT_TRUE(run(options()));
    EXPECT_EQ(uplink_->status().sent, kScans);
}

TEST_F(UplinkTest, AnUnexpectedFrameIsReportedAsAServerError) {
    std::string bytes;
    wire::encode(wire::Message(wire::Welcome{"f1", 0, {}, 20'000}), bytes);
    serve({{.answer_hello_with = bytes + "\xff\xff\xff\xff"}, {}});
    EXPECT_TRUE(run(options()));
    EXPECT_THAT(troubles_,
                ElementsAre("the data from the server cannot be read: a frame announces 4294967295 bytes, at "
                            "most 1048576 are allowed here"));
}

TEST_F(UplinkTest, ConnectsToAServerThatStartsLate) {
    serve({{}});
    const auto made = [&] {
        auto options_with_reopening = options();
        server_->close();
        options_with_reopening.on_trouble = [this](const Error&) {
            if (troubles_.empty()) server_->reopen();
            troubles_.emplace_back("away");
        };
        return options_with_reopening;
    }();
    EXPECT_TRUE(run(made));
    expect_all_stored_once();
    EXPECT_EQ(troubles_.size(), 1U);
}

TEST_F(UplinkTest, SendsNoScanBeforeItIsDue) {
    serve({{}});
    auto made = options();
    pace_.speed = 200.0; // 5 ms per scan
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_TRUE(run(made, 40));
    expect_all_stored_once(40);
    EXPECT_GE(std::chrono::steady_clock::now() - begun, 39 * 5ms);
}

TEST_F(UplinkTest, ALongPauseIsReportedAndLimitedToTenMinutes) {
    serve({{}});
    auto scans = numbered_scans(3);
    scans[2].scan.stamp = 1e9; // the clock was set
    source_.emplace(std::move(scans));
    auto made = options();
    pace_.speed = 5.0;
    std::vector<double> pauses;
    pace_.on_long_pause = [&](std::chrono::duration<double> pause) {
        pauses.push_back(pause.count());
        EXPECT_LE(uplink_->status().next_scan_in.value().count(), 120.0);
        uplink_->stop();
    };
    EXPECT_FALSE(run(made)) << "stopped before its last scan";
    EXPECT_THAT(pauses, ElementsAre(testing::Le(120.0)));
    EXPECT_FALSE(uplink_->status().next_scan_in);
    expect_all_stored_once(2);
}

TEST_F(UplinkTest, TheHelloIsTheSameOnEveryLink) {
    serve({{.hang_up_after_scans = 10}, {}});
    auto made = options();
    made.protocol.hello.create = SessionOptions{};
    made.protocol.hello.create->cell_size = 0.1;
    made.protocol.hello.client = "test";
    EXPECT_TRUE(run(made));
    ASSERT_EQ(server_->hellos().size(), 2U);
    EXPECT_EQ(server_->hellos()[0], made.protocol.hello);
    EXPECT_EQ(server_->hellos()[1], made.protocol.hello);
}

} // namespace
} // namespace scanloom::robot

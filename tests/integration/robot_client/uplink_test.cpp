#include "robot_client/uplink/recording_feed.hpp"
#include "robot_client/uplink/uplink.hpp"

#include "tests/integration/robot_client/fake_server.hpp"
#include "tests/support/recorded_source.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kScans = 500;

std::vector<Observation> recording(std::size_t scans = kScans) {
    const auto sensor = std::make_shared<const Sensor>(
        Sensor{0, SensorKind::kLaser, "laser", {}, UniformAngles{-1.5, 0.01, 90}, 0.0, 0.0, 10.0});
    std::vector<Observation> made(scans, Observation{sensor, {}});
    for (std::size_t i = 0; i < scans; ++i) {
        made[i].scan.stamp = static_cast<double>(i);
        made[i].scan.pose = {static_cast<double>(i + 1), 0.0, 0.0}; // identifies the scan
        made[i].scan.ranges.assign(90, 1000);
    }
    return made;
}

/// A robot and a server on one thread.
class UplinkTest : public testing::Test {
protected:
    void serve(std::vector<LinkScript> scripts) { server_.emplace(io_, std::move(scripts)); }

    UplinkOptions options() {
        UplinkOptions made;
        made.servers = {{"127.0.0.1", std::to_string(server_->port())}};
        made.protocol.hello.robot = "r1";
        made.protocol.hello.session = "s1";
        made.give_up_after = 20s;
        made.on_trouble = [this](const Error& error) { troubles_.push_back(error.message); };
        return made;
    }

    /// Runs until the uplink has its outcome.
    Result<> run(const UplinkOptions& made, std::size_t scans = kScans) {
        if (!source_) source_.emplace(recording(scans));
        feed_.emplace(*source_, pace_);
        uplink_.emplace(io_, made, *feed_);
        Result<> outcome = Error{Errc::kTimeout, "it did not end"};
        boost::asio::co_spawn(io_, uplink_->run(), [&](std::exception_ptr failed, Result<> result) {
            EXPECT_FALSE(failed);
            outcome = std::move(result);
            io_.stop();
        });
        io_.run();
        return outcome;
    }

    void expect_all_stored_once(std::size_t scans = kScans, std::size_t from_earlier = 0) {
        EXPECT_THAT(server_->faults(), IsEmpty());
        ASSERT_EQ(server_->stored().size(), scans);
        for (std::size_t i = from_earlier; i < scans; ++i) {
            EXPECT_EQ(server_->stored()[i].seq, i + 1);
            EXPECT_EQ(server_->stored()[i].pose->x, static_cast<double>(i + 1));
        }
    }

    boost::asio::io_context io_{1};
    std::optional<FakeServer> server_;
    std::optional<RecordedSource> source_;
    RecordingFeedOptions pace_;
    std::optional<RecordingFeed> feed_;
    std::optional<Uplink> uplink_;
    std::vector<std::string> troubles_;
};

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

TEST_F(UplinkTest, RetriesRetryableErrorsAndEndsOnFinalOnes) {
    serve({{.refuse_hello = wire::LinkError{{Errc::kShuttingDown, "draining; try again later"}, true}},
           {.hang_up_after_scans = 20, .error_after_scans = wire::LinkError{{Errc::kStoreFailed, "disk full"}, true}},
           {.hang_up_after_scans = 20,
            .error_after_scans = wire::LinkError{{Errc::kGone, "session s1 was deleted"}, false}}});
    const auto outcome = run(options());
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error(), (Error{Errc::kGone, "session s1 was deleted"}));
    EXPECT_THAT(troubles_, ElementsAre("draining; try again later", "disk full"));
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

TEST_F(UplinkTest, AStoredRecordingIsDoneImmediately) {
    serve({{}});
    server_->store_before(kScans);
    EXPECT_TRUE(run(options()));
    EXPECT_EQ(server_->goodbyes(), 1);
}

TEST_F(UplinkTest, ARunShorterThanTheStoredScansIsReported) {
    serve({{}});
    server_->store_before(kScans + 1);
    const auto outcome = run(options());
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("501 scans of this robot already, and this run ends with scan 500"));
    EXPECT_THAT(outcome.error().message, HasSubstr("--scans"));
    EXPECT_THAT(troubles_, IsEmpty()) << "this end of the link is not reported as trouble";
}

TEST_F(UplinkTest, AnotherProtocolIsReported) {
    serve({{.answer_hello_with = "HTTP/1.1 400 Bad Request\r\n\r\n"}});
    const auto outcome = run(options());
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("does not speak Scanloom's robot link"));
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

TEST_F(UplinkTest, GivesUpWithoutAServerAndReportsTheReason) {
    serve({{}});
    auto made = options();
    server_->close();
    made.give_up_after = 300ms;
    const auto outcome = run(made);
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("gave up after 0.3 s"));
    EXPECT_THAT(outcome.error().message, HasSubstr("is scanloom-server running there?"));
}

TEST_F(UplinkTest, GivingUpOnASilentServerNamesTheServer) {
    serve({{.silent_after_scans = 10}});
    auto made = options();
    made.give_up_after = 300ms;
    const auto outcome = run(made);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().message,
              "gave up after 0.3 s without progress: the server is connected but acknowledges nothing");
}

TEST_F(UplinkTest, GivingUpWithoutAnAnswerNamesTheServer) {
    serve({{.silent_after_scans = 0}});
    auto made = options();
    made.give_up_after = 300ms;
    const auto outcome = run(made);
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("no answer from 127.0.0.1:"));
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
    auto scans = recording(3);
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

TEST_F(UplinkTest, StopEndsTheSourceAndWaitsForAcknowledgements) {
    serve({{}});
    source_.emplace(recording());
    source_->pretend_to_be_endless();
    auto made = options();
    pace_.speed = 50.0;
    server_->on_stored = [&](std::size_t scans) {
        if (scans >= 5) uplink_->stop();
    };
    EXPECT_TRUE(run(made)) << "a source without an end is complete whenever it is stopped";
    const auto status = uplink_->status();
    EXPECT_GE(status.last, 5U);
    EXPECT_LT(status.last, kScans);
    EXPECT_EQ(status.acknowledged, status.last);
    EXPECT_TRUE(uplink_->outcome_when_interrupted()) << "ending immediately would not have lost a scan either";
    expect_all_stored_once(status.last);
    EXPECT_EQ(server_->goodbyes(), 1);
}

TEST_F(UplinkTest, AStoppedRecordingIsIncomplete) {
    serve({{}});
    auto made = options();
    pace_.speed = 50.0;
    server_->on_stored = [&](std::size_t scans) {
        if (scans >= 5) uplink_->stop();
    };
    const auto outcome = run(made);
    ASSERT_FALSE(outcome);
    const auto status = uplink_->status();
    EXPECT_EQ(status.acknowledged, status.last) << "it still waits for the sent scans";
    EXPECT_THAT(outcome.error().message, HasSubstr(fmt::format("interrupted after scan {} of 500", status.last)));
}

TEST_F(UplinkTest, ARecordingStoppedAfterItsLastScanIsComplete) {
    serve({{.ack_every = 1}});
    server_->on_stored = [&](std::size_t scans) {
        if (scans == 20) uplink_->stop();
    };
    EXPECT_TRUE(run(options(), 20));
    EXPECT_EQ(uplink_->status().acknowledged, 20U);
}

TEST_F(UplinkTest, AnUnreadableRecordingIsReported) {
    serve({{}});
    source_.emplace(recording());
    source_->fail_after(100);
    const auto outcome = run(options());
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().message, "the rest of the recording cannot be read");
    EXPECT_THAT(troubles_, IsEmpty());
}

TEST_F(UplinkTest, AnImpossibleNumberOfStoredScansIsRejected) {
    for (const bool endless : {false, true}) {
        serve({{.durable_seq = std::numeric_limits<std::uint64_t>::max()}});
        source_.emplace(recording());
        if (endless) source_->pretend_to_be_endless();
        const auto outcome = run(options());
        io_.restart();
        ASSERT_FALSE(outcome);
        EXPECT_EQ(outcome.error().code, Errc::kConflict);
        EXPECT_THAT(outcome.error().message, HasSubstr("18446744073709551615 scans of this robot"));
        EXPECT_EQ(uplink_->status().sent, 0U);
        uplink_.reset();
        feed_.reset();
        server_.reset();
    }
}

TEST_F(UplinkTest, ASessionOfAnotherRecordingEndsItWithTheServersMessage) {
    const Error other{Errc::kConflict, "robot r1 has streamed carmen:9f3a; choose another session"};
    serve({{.refuse_hello = wire::LinkError{other, false}}});
    auto made = options();
    made.protocol.hello.source = "carmen:0000";
    const auto outcome = run(made);
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error(), other);
    EXPECT_THAT(troubles_, IsEmpty()) << "a final error is not retried";
    EXPECT_EQ(server_->hellos().at(0).source, "carmen:0000");
}

TEST_F(UplinkTest, StopLimitsTheWaitForAcknowledgements) {
    serve({{.silent_after_scans = 1}});
    auto made = options();
    made.drain_max = 200ms;
    server_->on_stored = [&](std::size_t) { uplink_->stop(); };
    const auto outcome = run(made);
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("were not acknowledged within 0.2 s"));
    EXPECT_THAT(uplink_->outcome_when_interrupted().error().message, HasSubstr("scans were acknowledged"));
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

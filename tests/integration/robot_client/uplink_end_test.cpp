#include "tests/integration/robot_client/uplink_fixture.hpp"

#include <fmt/format.h>

#include <limits>

/// How a run ends: complete, stopped, given up or refused.
namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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

TEST_F(UplinkTest, GivesUpWithoutAServerAndReportsTheReason) {
    serve({{}});
    server_->close();
    const auto reason = reason_to_give_up();
    EXPECT_THAT(reason, HasSubstr("gave up after 0.3 s"));
    EXPECT_THAT(reason, HasSubstr("is scanloom-server running there?"));
}

TEST_F(UplinkTest, GivingUpOnASilentServerNamesTheServer) {
    serve({{.silent_after_scans = 10}});
    EXPECT_EQ(reason_to_give_up(),
              "gave up after 0.3 s without progress: the server is connected but acknowledges nothing");
}

TEST_F(UplinkTest, GivingUpWithoutAnAnswerNamesTheServer) {
    serve({{.silent_after_scans = 0}});
    EXPECT_THAT(reason_to_give_up(), HasSubstr("no answer from 127.0.0.1:"));
}

TEST_F(UplinkTest, StopEndsTheSourceAndWaitsForAcknowledgements) {
    serve({{}});
    source_.emplace(numbered_scans(kScans));
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
    source_.emplace(numbered_scans(kScans));
    source_->fail_after(100);
    const auto outcome = run(options());
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().message, "the rest of the recording cannot be read");
    EXPECT_THAT(troubles_, IsEmpty());
}

TEST_F(UplinkTest, AnImpossibleNumberOfStoredScansIsRejected) {
    for (const bool endless : {false, true}) {
        serve({{.durable_seq = std::numeric_limits<std::uint64_t>::max()}});
        source_.emplace(numbered_scans(kScans));
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

} // namespace
} // namespace scanloom::robot

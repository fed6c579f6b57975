#include "tests/unit/robot_client/uplink/client_protocol_fixture.hpp"

#include <gmock/gmock.h>

/// What ends a link, or the robot's attempts.
namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// One replacement may be a late hello of an earlier link; repeated ones are another program.
TEST_F(ClientProtocolTest, GivesUpAfterRepeatedReplacement) {
    const wire::LinkError replaced{{Errc::kReplaced, "robot 'r1' connected again"}, false};
    const auto end_of_link = [&] {
        welcome();
        const auto failure = client_.receive(replaced, now_);
        client_.protocol.close();
        return failure.value();
    };
    for (int n = 0; n < 4; ++n) { // seldom
        EXPECT_TRUE(end_of_link().retryable);
        now_ += 60s;
    }
    EXPECT_TRUE(end_of_link().retryable);
    now_ += 1s;
    EXPECT_TRUE(end_of_link().retryable);
    now_ += 1s;
    const auto last = end_of_link();
    EXPECT_FALSE(last.retryable);
    EXPECT_THAT(last.error.message, HasSubstr("another program uses the same --robot and --session"));
}

TEST_F(ClientProtocolTest, ScanBeyondTheServersLimitsIsAFinalError) {
    welcome(0, kPlenty, {kPlenty, 100, 3});
    add(1);
    EXPECT_TRUE(sent_seqs().empty());
    const auto failure = client_.protocol.check(now_);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("scan 1 has 180 beams, the server takes at most 100"));
}

TEST_F(ClientProtocolTest, LostAcknowledgedScansAreAFinalError) {
    const auto failure = welcomed_after_eight_acks({"a1", 5, {}, kPlenty});
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("scans 6 to 8 are no longer in memory"));
    EXPECT_EQ(client_.protocol.lost_scans(), 3U);
}

TEST_F(ClientProtocolTest, RecreatedSessionIsAFinalError) {
    const auto failure = welcomed_after_eight_acks({"b2", 0, {}, kPlenty});
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("created again"));
    EXPECT_EQ(client_.protocol.lost_scans(), 8U);
}

TEST_F(ClientProtocolTest, ServerErrorsEndTheLink) {
    welcome();
    for (const bool retryable : {true, false}) {
        const wire::LinkError said_by_server{{Errc::kConflict, "cell_size is 0.05 there"}, retryable};
        EXPECT_EQ(client_.receive(said_by_server, now_), said_by_server);
    }
    EXPECT_TRUE(client_.receive(wire::Goodbye{"restarting"}, now_)->retryable);
}

TEST_F(ClientProtocolTest, UnexpectedFramesEndTheLink) {
    client_.protocol.open("host:1", now_);
    EXPECT_THAT(client_.receive(wire::Ack{}, now_)->error.message, HasSubstr("unexpected ack"));
    EXPECT_TRUE(client_.receive(wire::Welcome{}, now_)) << "before the hello";
    welcome();
    EXPECT_TRUE(client_.receive(wire::Welcome{}, now_)) << "a second welcome";
    EXPECT_TRUE(client_.receive(wire::Hello{}, now_));
    EXPECT_TRUE(client_.receive(wire::ScanBatch{}, now_));
    EXPECT_THAT(ack(1)->error.message, HasSubstr("acknowledged scan 1, only 0 were sent"));
    EXPECT_FALSE(client_.receive(wire::Correction{}, now_));
}

TEST_F(ClientProtocolTest, SilentLinkFailsAndAnyFrameKeepsItAlive) {
    welcome();
    now_ += 14s;
    EXPECT_FALSE(client_.protocol.check(now_));
    ASSERT_FALSE(client_.receive(wire::Pong{1}, now_));
    now_ += 14s;
    EXPECT_FALSE(client_.protocol.check(now_));
    now_ += 1s;
    ASSERT_TRUE(client_.protocol.check(now_));
    EXPECT_TRUE(client_.protocol.check(now_)->retryable);
    EXPECT_THAT(client_.protocol.check(now_)->error.message, HasSubstr("nothing came from the server for 15 s"));
}

TEST_F(ClientProtocolTest, UnansweredHelloFailsTheLink) {
    client_.protocol.open("host:1", now_);
    sent_messages();
    EXPECT_EQ(client_.protocol.deadline(now_), kStart + 10s);
    EXPECT_FALSE(client_.protocol.check(now_ + 9999ms));
    EXPECT_THAT(client_.protocol.check(now_ + 10s)->error.message, HasSubstr("did not answer the hello within 10 s"));
}

TEST_F(ClientProtocolTest, InvalidBytesAreAFinalErrorOnlyOfASingleServerBeforeTheWelcome) {
    client_.protocol.open("host:1", now_);
    const auto other = client_.receive_bytes("HTTP/1.1 400 Bad Request\r\n", now_);
    ASSERT_TRUE(other);
    EXPECT_FALSE(other->retryable);
    EXPECT_THAT(other->error.message, HasSubstr("the program at host:1 does not speak Scanloom's robot link"));
    client_.protocol.close();
    welcome();
    const auto damaged = client_.receive_bytes(std::string(4, '\xff'), now_);
    ASSERT_TRUE(damaged);
    EXPECT_TRUE(damaged->retryable);
    EXPECT_THAT(damaged->error.message, testing::StartsWith("the data from the server cannot be read: "));

    client_.protocol.close();
    ClientLink client(client_options(), kStart);
    client.protocol.open("host:1", now_, true);
    EXPECT_TRUE(client.receive_bytes("HTTP/1.1 400 Bad Request\r\n", now_)->retryable) << "on another server";
}

TEST_F(ClientProtocolTest, ServersScansWithoutAnEarlierRunAreAConflict) {
    auto fresh = client_options();
    fresh.continues_earlier_run = false;
    ClientLink client(fresh, kStart);
    client.protocol.open("host:1", now_);
    EXPECT_EQ(client.sent(now_).size(), 1U);
    const auto failure = client.receive(wire::Welcome{"a1", 3, {}, kPlenty}, now_);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("holds 3 scans of this robot, only 0 were sent from here"));
    EXPECT_EQ(client.protocol.lost_scans(), 0U);
}

TEST_F(ClientProtocolTest, ControlCharactersOfTheServerAreEscaped) {
    welcome();
    const auto refused = client_.receive(wire::LinkError{{Errc::kConflict, "no\x1b[2J\xc2\x9b!"}, false}, now_);
    ASSERT_TRUE(refused);
    EXPECT_EQ(*refused, (wire::LinkError{{Errc::kConflict, R"(no\x1b[2J\xc2\x9b!)"}, false}));
    const auto left = client_.receive(wire::Goodbye{std::string(5'000, '\a')}, now_);
    ASSERT_TRUE(left);
    EXPECT_THAT(left->error.message, testing::StartsWith(R"(the server said goodbye: \x07\x07)"));
    EXPECT_LT(left->error.message.size(), 600U);
}

TEST_F(ClientProtocolTest, MissingErrorMessageIsReplaced) {
    welcome();
    EXPECT_EQ(client_.receive(wire::LinkError{{Errc::kConflict, ""}, false}, now_)->error.message,
              "the server ended the link with the error conflict and gave no reason");
    EXPECT_EQ(client_.receive(wire::Goodbye{}, now_)->error.message, "the server said goodbye without a reason");
}

TEST_F(ClientProtocolTest, UnexpectedReplyEndsTheLink) {
    welcome();
    const auto failure = client_.receive(wire::PlanReply{1, 5, Error{Errc::kNoPath, "a wall"}}, now_);
    ASSERT_TRUE(failure);
    EXPECT_THAT(failure->error.message, HasSubstr("unexpected plan_reply"));
}

} // namespace
} // namespace scanloom::robot

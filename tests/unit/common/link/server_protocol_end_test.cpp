#include "tests/unit/common/link/protocol_owner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace scanloom::link {
namespace {

using testing::ElementsAre;
using testing_support::random_scans;
using Reading = ServerProtocol::Reading;

TEST(ServerProtocolEnd, GoodbyeWaitsForScansAndReplies) {
    Owner owner;
    owner.join();
    owner.receive(frame_of(wire::ScanBatch{random_scans(1, 1, 1)}) + frame_of(wire::PlanRequest{.id = 1}) +
                  frame_of(wire::Goodbye{}));
    EXPECT_THAT(owner.take(), ElementsAre("scans 1..1", "answer"));
    EXPECT_EQ(owner.protocol.reading(), Reading::kNothing);
    owner.durable(1, owner.submitted);
    EXPECT_THAT(owner.take(), ElementsAre("send ack 1"));
    owner.protocol.on_reply(frame_of(refusal_of(owner.requests.front(), {Errc::kNoPath, "x"})), nullptr);
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("leave", "send plan_reply", "shut down"));
    EXPECT_FALSE(owner.protocol.ended_by());
}

TEST(ServerProtocolEnd, FailureAfterTheGoodbyeIsSent) {
    Owner owner;
    owner.join();
    owner.receive(frame_of(wire::ScanBatch{random_scans(1, 1, 1)}) + frame_of(wire::Goodbye{}));
    owner.protocol.fail({Errc::kStoreFailed, "no space left"});
    owner.advance();
    EXPECT_EQ(owner.error(), (wire::LinkError{{Errc::kStoreFailed, "no space left"}, true}));
}

TEST(ServerProtocolEnd, PendingAckIsSentBeforeTheError) {
    Owner owner;
    owner.join();
    owner.completes_writes = false;
    owner.durable(1, 0);
    owner.durable(2, 0);
    owner.protocol.fail({Errc::kShuttingDown, "bye"});
    owner.advance();
    owner.durable(3, 0);
    owner.done.clear();
    owner.protocol.on_written();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("send ack 2", "send error"));
    owner.protocol.on_written();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("shut down")) << "no ack after the error";
}

TEST(ServerProtocolEnd, OnlyTheFirstFailureCounts) {
    Owner owner;
    owner.open();
    owner.receive(hello());
    owner.protocol.fail({Errc::kUnauthorized, "revoked"});
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("join r")) << "joining completes first";
    owner.protocol.on_joined({"5e55"}, owner.now);
    owner.protocol.fail({Errc::kGone, "deleted"});
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("leave", "send welcome", "send error", "shut down"));
    EXPECT_EQ(owner.error().error.code, Errc::kUnauthorized);
}

TEST(ServerProtocolEnd, NothingIsSentAfterTheRobotCloses) {
    Owner owner;
    owner.join();
    owner.receive(frame_of(wire::ScanBatch{random_scans(1, 1, 1)}) + frame_of(wire::Ping{}).substr(0, 3));
    owner.done.clear();
    owner.protocol.on_read_failed();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("leave", "close"));
    EXPECT_EQ(owner.protocol.ended_by()->code, Errc::kUnreachable);
}

TEST(ServerProtocolEnd, FailedHandshakeEndsTheConnection) {
    Owner owner;
    owner.protocol.on_handshake_failed();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("leave", "shut down"));
    EXPECT_EQ(owner.protocol.reading(), Reading::kUntilEnd) << "so that the client can read the alert";
}

TEST(ServerProtocolEnd, FailedWriteDiscardsTheQueue) {
    Owner owner;
    owner.join();
    owner.completes_writes = false;
    owner.durable(1, 0);
    owner.durable(2, 0);
    owner.protocol.on_write_failed();
    owner.protocol.fail({Errc::kGone, "deleted"});
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("send ack 1", "leave", "shut down"));
}

TEST(ServerProtocolEnd, BytesThatArriveAfterTheEndAreDiscarded) {
    Owner owner;
    owner.join();
    const auto room = owner.protocol.prepare();
    owner.protocol.fail({Errc::kGone, "deleted"});
    owner.advance();
    const std::string ping = frame_of(wire::Ping{});
    std::ranges::copy(std::as_bytes(std::span(ping)), room.begin());
    owner.protocol.on_bytes(ping.size(), owner.now);
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("leave", "send error", "shut down"));
    owner.protocol.on_read_failed();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("close"));
}

} // namespace
} // namespace scanloom::link

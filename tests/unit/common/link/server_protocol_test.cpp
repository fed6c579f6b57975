#include "tests/unit/common/link/protocol_owner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace scanloom::link {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing_support::random_scans;
using testing_support::small_laser;
using Time = ServerProtocol::Time;
using Reading = ServerProtocol::Reading;

TEST(ServerProtocol, JoinsWelcomesSubmitsAndAcknowledges) {
    Owner owner;
    EXPECT_EQ(owner.protocol.reading(), Reading::kNothing) << "before the handshake";
    owner.open();
    owner.receive(hello() + frame_of(small_laser()));
    EXPECT_THAT(owner.take(), ElementsAre("join r"));
    EXPECT_EQ(owner.protocol.reading(), Reading::kNothing) << "while the robot joins";
    owner.protocol.on_joined({"5e55", 7}, owner.now);
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("sensor 2", "send welcome"));
    EXPECT_EQ(owner.sent.front(),
              wire::Message(wire::Welcome{"5e55", 7, {1U << 20, 4096, 1024}, std::size_t{2} << 20, true}));
    owner.receive(frame_of(wire::ScanBatch{random_scans(1, 8, 3)}) + frame_of(wire::Ping{5}));
    EXPECT_THAT(owner.take(), ElementsAre("scans 8..10", "send pong"));
    owner.durable(10, owner.submitted);
    EXPECT_THAT(owner.take(), ElementsAre("send ack 10"));
}

TEST(ServerProtocol, AnySplitOfTheBytesGivesTheSameActions) {
    const std::string bytes = frame_of(small_laser()) + frame_of(wire::ScanBatch{random_scans(1, 1, 2)}) +
                              frame_of(wire::PlanRequest{.id = 1}) + frame_of(wire::Ping{1}) + frame_of(wire::Pong{1}) +
                              frame_of(wire::Goodbye{});
    for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
        Owner owner;
        owner.open();
        owner.receive(hello(), piece);
        owner.protocol.on_joined({"5e55"}, owner.now);
        owner.advance();
        owner.receive(bytes, piece);
        EXPECT_THAT(owner.take(), testing::UnorderedElementsAre("join r", "send welcome", "sensor 2", "scans 1..2",
                                                                "answer", "send pong"))
            << piece;
        EXPECT_FALSE(owner.protocol.ended_by());
    }
}

TEST(ServerProtocol, NoScanIsAcknowledgedBeforeItIsDurable) {
    Owner owner;
    owner.join();
    owner.receive(frame_of(small_laser()) + frame_of(wire::ScanBatch{random_scans(1, 1, 3)}));
    owner.receive(frame_of(wire::Ping{1}) + frame_of(wire::ScanBatch{random_scans(1, 4, 3)}));
    EXPECT_THAT(owner.take(), ElementsAre("sensor 2", "scans 1..3", "scans 4..6", "send pong"));
    owner.durable(3, 100);
    EXPECT_THAT(owner.take(), ElementsAre("send ack 3"));
}

TEST(ServerProtocol, OfSeveralAcksOnlyTheNewestIsWritten) {
    Owner owner;
    owner.join();
    owner.completes_writes = false;
    for (std::uint64_t seq = 1; seq <= 3; ++seq) owner.durable(seq, 0);
    EXPECT_THAT(owner.take(), ElementsAre("send ack 1"));
    owner.receive(frame_of(wire::Ping{1}));
    owner.durable(4, 0);
    owner.protocol.on_written();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("send ack 3", "send pong", "send ack 4"));
}

TEST(ServerProtocol, RepliesFollowWhenNothingElseWaits) {
    Owner owner;
    owner.join();
    owner.completes_writes = false;
    owner.durable(1, 0);
    const auto kept = std::make_shared<int>(1);
    owner.receive(frame_of(wire::PlanRequest{.id = 3}));
    owner.protocol.on_reply(frame_of(refusal_of(owner.requests.front(), {Errc::kNoPath, "x"})), kept);
    owner.receive(frame_of(wire::Ping{1}));
    EXPECT_EQ(kept.use_count(), 2) << "until it is written";
    owner.done.clear();
    owner.protocol.on_written();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("send pong"));
    owner.protocol.on_written();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("send plan_reply"));
}

TEST(ServerProtocolCorrection, NewestIsSentAtMostTwentyTimesASecond) {
    Owner owner;
    owner.join();
    owner.locate(1);
    EXPECT_THAT(owner.take(), ElementsAre("send correction 1"));
    owner.pass(10ms);
    for (std::uint64_t revision = 2; revision <= 5; ++revision) owner.locate(revision);
    EXPECT_EQ(owner.protocol.deadline(), owner.now + 40ms) << "so that the last one is sent without another event";
    owner.pass(40ms - 1ns);
    EXPECT_THAT(owner.take(), IsEmpty());
    owner.pass(1ns);
    EXPECT_THAT(owner.take(), ElementsAre("send correction 5"));
    EXPECT_GT(owner.protocol.deadline(), owner.now + 1s) << "none is pending";
    owner.pass(50ms);
    owner.locate(6);
    EXPECT_THAT(owner.take(), ElementsAre("send correction 6")) << "at once after a pause";
}

TEST(ServerProtocolCorrection, OfSeveralOnlyTheNewestIsSentToASlowReader) {
    Owner owner;
    owner.join();
    owner.completes_writes = false;
    owner.durable(1, 0);
    owner.locate(1);
    owner.locate(2);
    owner.durable(2, 0);
    owner.pass(1s);
    EXPECT_THAT(owner.take(), ElementsAre("send ack 1"));
    EXPECT_GT(owner.protocol.deadline(), owner.now) << "the end of the write is the next event";
    owner.protocol.on_written();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("send ack 2", "send correction 2"));
}

TEST(ServerProtocolCorrection, NoneBeforeTheWelcomeOrAfterTheGoodbye) {
    Owner owner;
    owner.open();
    owner.receive(hello());
    owner.locate(1);
    EXPECT_THAT(owner.take(), ElementsAre("join r"));
    EXPECT_EQ(owner.protocol.deadline(), Time::max());
    owner.protocol.on_joined({"5e55"}, owner.now);
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("send welcome", "send correction 1"));
    owner.locate(2);
    owner.receive(frame_of(wire::ScanBatch{random_scans(1, 1, 1)}) + frame_of(wire::Goodbye{}));
    owner.locate(3);
    owner.pass(1s);
    EXPECT_THAT(owner.take(), ElementsAre("scans 1..1"));
    EXPECT_EQ(owner.protocol.deadline(), Time::max());
    owner.durable(1, owner.submitted);
    EXPECT_THAT(owner.take(), ElementsAre("leave", "send ack 1", "shut down"));
}

} // namespace
} // namespace scanloom::link

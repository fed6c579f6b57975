#include "tests/unit/common/link/protocol_owner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace scanloom::link {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;
using testing_support::random_scans;
using Time = ServerProtocol::Time;
using Reading = ServerProtocol::Reading;

TEST(ServerProtocolDeadline, HandshakeAndHello) {
    Owner shaking;
    shaking.pass(5s - 1ms);
    EXPECT_THAT(shaking.take(), IsEmpty());
    shaking.pass(1ms);
    EXPECT_THAT(shaking.take(), ElementsAre("leave", "shut down")) << "an Error cannot be sent";
    EXPECT_EQ(shaking.protocol.ended_by()->message, "no hello was received in time");
    shaking.pass(2s);
    EXPECT_THAT(shaking.take(), ElementsAre("close"));

    Owner silent;
    silent.pass(2s);
    silent.open();
    silent.receive(hello().substr(0, 10));
    silent.pass(3s);
    EXPECT_THAT(silent.take(), ElementsAre("leave", "send error", "shut down"));
    EXPECT_EQ(silent.error().error, (Error{Errc::kTimeout, "no hello was received in time"}));
    EXPECT_TRUE(silent.error().retryable);
}

TEST(ServerProtocolDeadline, OnlyWholeFramesKeepALinkAlive) {
    Owner owner;
    owner.join();
    owner.pass(59s);
    owner.receive(frame_of(wire::Ping{}));
    owner.pass(59s);
    owner.receive(frame_of(wire::Ping{}).substr(0, 3));
    EXPECT_FALSE(owner.protocol.ended_by());
    owner.pass(1s);
    EXPECT_EQ(owner.error().error.code, Errc::kTimeout);
    EXPECT_THAT(owner.error().error.message, StartsWith("nothing was received for too long"));
}

TEST(ServerProtocolDeadline, NoneWhileTheServerIsBusy) {
    Owner owner;
    owner.open();
    owner.receive(hello());
    EXPECT_EQ(owner.protocol.deadline(), Time::max()) << "joining";
    owner.protocol.on_joined({"5e55"}, owner.now);
    owner.advance();
    owner.receive(frame_of(wire::ScanBatch{random_scans(1, 1, 1)}) + frame_of(wire::Goodbye{}));
    EXPECT_EQ(owner.protocol.deadline(), Time::max()) << "settling";
}

TEST(ServerProtocolDeadline, UnreadErrorIsClosedAtTheDeadline) {
    Owner owner;
    owner.join();
    owner.completes_writes = false;
    owner.protocol.fail({Errc::kGone, "deleted"});
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("leave", "send error"));
    owner.pass(2s);
    EXPECT_THAT(owner.take(), ElementsAre("close"));
    EXPECT_EQ(owner.protocol.deadline(), Time::max());
}

TEST(ServerProtocolDeadline, OpenConnectionIsClosedAtTheDeadline) {
    Owner owner;
    owner.join();
    owner.receive(frame_of(wire::Goodbye{}));
    EXPECT_THAT(owner.take(), ElementsAre("leave", "shut down"));
    EXPECT_EQ(owner.protocol.reading(), Reading::kUntilEnd);
    owner.pass(2s);
    EXPECT_THAT(owner.take(), ElementsAre("close"));
}

TEST(ServerProtocolDeadline, RateLimitPauseMovesIt) {
    Owner owner;
    owner.join();
    owner.protocol.set_limits({.token = "depot", .bytes_per_second = 1024.0}, owner.now);
    owner.pass(30s);
    const auto before = owner.protocol.deadline();
    std::string pings;
    while (pings.size() < 2048) pings += frame_of(wire::Ping{});
    EXPECT_LE(owner.protocol.prepare().size(), 1024U) << "so that the pause is at most a second";
    owner.receive(pings.substr(0, 1024));
    EXPECT_EQ(owner.protocol.reading(), Reading::kFrames) << "one second's bytes were saved";
    owner.receive(pings.substr(1024, 1024));
    EXPECT_EQ(owner.protocol.reading(), Reading::kNothing);
    EXPECT_EQ(owner.paused, 1s);
    EXPECT_EQ(owner.protocol.deadline(), owner.now + 1s);
    owner.done.clear();
    owner.pass(1s);
    EXPECT_FALSE(owner.take().empty()) << "frames are taken after the pause";
    EXPECT_EQ(owner.protocol.reading(), Reading::kFrames);
    EXPECT_GE(owner.protocol.deadline(), before + 1s);
}

} // namespace
} // namespace scanloom::link

#include "tests/unit/common/link/protocol_owner.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace scanloom::link {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing_support::random_scan;
using testing_support::random_scans;
using testing_support::small_laser;

/// What a robot sends after its welcome, and why it is refused.
struct Refused {
    std::string bytes;
    Errc code;
    std::string message;
};

TEST(ServerProtocolRefusal, EndsTheLinkAndSaysWhy) {
    Sensor foreign = small_laser();
    foreign.id = 3;
    std::string damaged = frame_of(wire::Ping{77});
    damaged[5] = static_cast<char>(damaged[5] ^ 1);
    std::string no_message;
    wire::append_checked_frame(no_message, "\xff");
    Scan wide = random_scan(1, 1);
    wide.ranges.resize(30);
    const std::vector<Refused> cases = {
        {std::string("\x00\x20\x00\x00", 4), Errc::kTooLarge, "; send fewer scans per batch"},
        {damaged, Errc::kDamaged, ""},
        {no_message, Errc::kMalformed, ""},
        {hello(), Errc::kMalformed, "a hello frame is not for the server; after the hello it takes"},
        {frame_of(wire::Ack{}), Errc::kMalformed, "a ack frame is not for the server"},
        {frame_of(wire::CompressedScanBatch{100, "x"}), Errc::kMalformed, "no Zstandard frame"},
        {frame_of(small_laser()) + frame_of(foreign), Errc::kTooLarge, "the limit `sensors` of the token 'depot'"},
        {frame_of(wire::ScanBatch{{wide}}), Errc::kTooLarge, "has 30 beams, the limit `beams` of the token 'depot'"},
        {frame_of(wire::ScanBatch{random_scans(1, 1, 20)}), Errc::kCreditExceeded,
         "bytes of scan batches are under way, the credit is 500; wait for acks"},
    };
    for (const auto& refused : cases) {
        Owner owner({.credit_bytes = 500});
        owner.join();
        owner.protocol.set_limits({.token = "depot", .sensors = 1, .beams = 20}, owner.now);
        owner.receive(refused.bytes);
        EXPECT_EQ(owner.error().error.code, refused.code) << owner.error().error.message;
        EXPECT_THAT(owner.error().error.message, HasSubstr(refused.message));
        EXPECT_EQ(owner.error().retryable, refused.code == Errc::kDamaged);
        const bool is_limit = refused.message.find("limit `") != std::string::npos;
        const auto done = owner.take();
        EXPECT_EQ(std::ranges::count(done, "record limit"), is_limit ? 1 : 0) << refused.message;
        EXPECT_EQ(done.back(), "shut down");
    }
}

TEST(ServerProtocolRefusal, OfTheFirstFrame) {
    Owner ping;
    ping.open();
    ping.receive(frame_of(wire::Ping{}));
    EXPECT_EQ(ping.error().error, (Error{Errc::kMalformed, "the first frame is a ping; a hello is expected"}));

    Owner large;
    large.open();
    large.receive(std::string("\x00\x01\x00\x00", 4));
    EXPECT_EQ(large.error().error.code, Errc::kTooLarge) << "frames before the hello are small";

    Owner browser;
    browser.open();
    browser.receive("GET / HTTP/1.1\r\n\r\n");
    EXPECT_THAT(browser.raw, StartsWith("HTTP/1.1 400 Bad Request\r\n"));
    EXPECT_THAT(browser.raw, HasSubstr("browsers to the HTTP port"));
    EXPECT_THAT(browser.sent, IsEmpty());
}

TEST(ServerProtocolRefusal, OfARobotThatMayNotJoin) {
    Owner owner;
    owner.open();
    owner.receive(hello());
    owner.protocol.on_not_joined({Errc::kUnauthorized, "hello.token: no"});
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("join r", "leave", "send error", "shut down"));
    EXPECT_EQ(owner.error(), (wire::LinkError{{Errc::kUnauthorized, "hello.token: no"}, false}));
}

TEST(ServerProtocolRefusal, OfDescriptionsThatAreNotDurable) {
    Sensor large = small_laser();
    large.angles = ExplicitAngles(kBeamsMax, 0.5);
    const std::string frame = frame_of(large);
    Owner owner;
    owner.join();
    const std::size_t allowed = (std::size_t{6} << 20) / frame.size();
    for (std::size_t n = 0; n < allowed; ++n) owner.receive(frame);
    EXPECT_FALSE(owner.protocol.ended_by());
    owner.receive(frame_of(wire::ScanBatch{random_scans(1, 1, 3)}));
    EXPECT_FALSE(owner.protocol.ended_by()) << "descriptions use no credit of scans";
    owner.receive(frame);
    EXPECT_EQ(owner.error().error.code, Errc::kCreditExceeded);
    EXPECT_THAT(owner.error().error.message, HasSubstr("bytes of sensor descriptions are under way"));
}

TEST(ServerProtocolRefusal, OfPingsWhosePongsAreNotRead) {
    Owner owner;
    owner.join();
    owner.completes_writes = false;
    for (int n = 0; n < 10'000 && !owner.protocol.ended_by(); ++n) owner.receive(frame_of(wire::Ping{}));
    ASSERT_TRUE(owner.protocol.ended_by());
    EXPECT_EQ(owner.protocol.ended_by()->code, Errc::kCreditExceeded);
    EXPECT_THAT(owner.protocol.ended_by()->message, HasSubstr("wait to be read, at most 65536 may"));
}

TEST(ServerProtocolRefusal, OfRequestsBeyondFourLetsTheLinkContinue) {
    Owner owner;
    owner.join();
    for (std::uint64_t id = 1; id <= 5; ++id) owner.receive(frame_of(wire::PlanRequest{.id = id}));
    EXPECT_EQ(owner.requests.size(), 4U);
    const auto& refused = std::get<wire::PlanReply>(owner.sent.back());
    EXPECT_EQ(refused.id, 5U);
    EXPECT_THAT(refused.result.error().message, StartsWith("4 requests are under way"));
    owner.protocol.on_request_refused(owner.requests.front(), {Errc::kOverloaded, "too many robots"});
    owner.advance();
    EXPECT_EQ(std::get<wire::PlanReply>(owner.sent.back()).id, 1U);
    owner.receive(frame_of(wire::PlanRequest{.id = 6}));
    EXPECT_EQ(owner.requests.size(), 5U);
}

TEST(ServerProtocolRefusal, OfARobotBeyondTheLimits) {
    Owner owner;
    owner.protocol.turn_away({{Errc::kOverloaded, "full"}, true}, owner.now);
    owner.open();
    EXPECT_THAT(owner.take(), ElementsAre("send error", "shut down"));
    EXPECT_EQ(owner.error(), (wire::LinkError{{Errc::kOverloaded, "full"}, true}));
    owner.protocol.on_read_failed();
    owner.advance();
    EXPECT_THAT(owner.take(), ElementsAre("close"));

    Owner slow;
    slow.protocol.turn_away({{Errc::kOverloaded, "full"}, true}, slow.now);
    slow.pass(2s);
    EXPECT_THAT(slow.take(), ElementsAre("shut down")) << "the handshake timed out";
}

} // namespace
} // namespace scanloom::link

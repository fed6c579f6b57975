#include "common/link/server_protocol.hpp"

#include "tests/support/random_scans.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
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
using Time = ServerProtocol::Time;
using Reading = ServerProtocol::Reading;

std::string frame_of(const wire::Message& message) {
    std::string frame;
    wire::encode(message, frame);
    return frame;
}

std::string hello() { return frame_of(wire::Hello{.robot = "r", .session = "lab"}); }

/// Runs a protocol, records its actions as words, and completes each write at once if `completes_writes`.
class Owner {
public:
    explicit Owner(const ServerProtocolConfig& config = {}) : protocol(config, now) {}

    void advance() {
        while (auto action = protocol.next_action(now)) std::visit([this](auto& one) { perform(one); }, *action);
    }

    /// Delivers bytes in pieces of at most `piece` bytes.
    void receive(std::string_view bytes, std::size_t piece = 1 << 20) {
        while (!bytes.empty() && protocol.reading() == Reading::kFrames) {
            const auto room = protocol.prepare();
            const std::size_t count = std::min({piece, room.size(), bytes.size()});
            std::ranges::copy(std::as_bytes(std::span(bytes).first(count)), room.begin());
            paused += protocol.on_bytes(count, now);
            bytes.remove_prefix(count);
            advance();
        }
    }

    void open() {
        protocol.on_open();
        advance();
    }

    void join(std::uint64_t durable = 0) {
        open();
        receive(hello());
        protocol.on_joined({"5e55", durable}, now);
        advance();
        done.clear();
    }

    void durable(std::uint64_t seq, std::size_t bytes) {
        protocol.on_durable(seq, bytes);
        advance();
    }

    void locate(std::uint64_t revision) {
        protocol.on_located({.revision = revision});
        advance();
    }

    void pass(ServerProtocol::Duration time) {
        now += time;
        if (now >= protocol.deadline()) protocol.on_timer(now);
        advance();
    }

    [[nodiscard]] std::vector<std::string> take() { return std::exchange(done, {}); }
    /// The last message to the robot. Pre: it is an Error frame.
    [[nodiscard]] const wire::LinkError& error() const { return std::get<wire::LinkError>(sent.back()); }

    Time now{5h};
    ServerProtocol protocol;
    std::vector<std::string> done;
    std::vector<wire::Message> sent;
    std::string raw; ///< sent bytes that are no frame
    std::vector<Request> requests;
    std::size_t submitted = 0; ///< bytes of credit
    ServerProtocol::Duration paused{};
    bool completes_writes = true;

private:
    void perform(const ServerProtocol::Join& action) { done.push_back("join " + action.hello.robot); }
    void perform(const ServerProtocol::SubmitSensor& action) {
        submitted += action.bytes;
        done.push_back(fmt::format("sensor {}", action.sensor.id));
    }
    void perform(const ServerProtocol::SubmitScans& action) {
        submitted += action.bytes;
        done.push_back(fmt::format("scans {}..{}", action.scans.front().seq, action.scans.back().seq));
    }
    void perform(const ServerProtocol::AnswerRequest& action) {
        requests.push_back(action.request);
        done.emplace_back("answer");
    }
    void perform(const ServerProtocol::RecordLimit&) { done.emplace_back("record limit"); }
    void perform(const ServerProtocol::Leave&) { done.emplace_back("leave"); }
    void perform(const ServerProtocol::ShutDownSending&) { done.emplace_back("shut down"); }
    void perform(const ServerProtocol::Close&) { done.emplace_back("close"); }
    void perform(const ServerProtocol::Send& action) {
        wire::FrameDecoder decoder(wire::kFrameBytesMax);
        std::ranges::copy(std::as_bytes(std::span(action.bytes)), decoder.prepare(action.bytes.size()).begin());
        decoder.commit(action.bytes.size());
        auto body = decoder.next();
        if (!body) raw += action.bytes;
        for (; body && *body; body = decoder.next()) {
            sent.push_back(wire::decode(**body).value());
            const auto* ack = std::get_if<wire::Ack>(&sent.back());
            const auto* correction = std::get_if<wire::Correction>(&sent.back());
            done.push_back("send " + std::string(wire::name_of(sent.back())) +
                           (ack ? fmt::format(" {}", ack->durable_seq) : "") +
                           (correction ? fmt::format(" {}", correction->revision) : ""));
        }
        if (completes_writes) protocol.on_written();
    }
};

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

// Corrections ---------------------------------------------------------------------------------------------------------

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

// Deadlines -----------------------------------------------------------------------------------------------------------

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

// Refusals ------------------------------------------------------------------------------------------------------------

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

// Ends ----------------------------------------------------------------------------------------------------------------

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

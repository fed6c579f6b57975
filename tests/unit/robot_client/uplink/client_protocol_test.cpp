#include "tests/unit/robot_client/uplink/client_link.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Time = ClientLink::Time;

constexpr Time kStart{1000s};
constexpr std::uint64_t kPlenty = 1 << 20;

std::shared_ptr<const Sensor> laser(double range_max = 10.0) {
    return std::make_shared<const Sensor>(
        Sensor{0, SensorKind::kLaser, "laser", {}, UniformAngles{-1.5, 0.01, 180}, 0.0, 0.0, range_max});
}

Observation observation(std::shared_ptr<const Sensor> sensor, std::size_t beams = 180) {
    Observation made{std::move(sensor), {}};
    made.scan.ranges.assign(beams, 1000);
    return made;
}

link::ClientProtocolOptions options() {
    link::ClientProtocolOptions made;
    made.hello.robot = "r1";
    made.hello.session = "s1";
    return made;
}

/// A client and what it sends.
class ClientProtocolTest : public testing::Test {
protected:
    void welcome(std::uint64_t last_durable = 0, std::uint64_t credit = kPlenty, wire::Limits limits = {}) {
        client_.protocol.open("host:1", now_);
        ASSERT_TRUE(std::holds_alternative<wire::Hello>(sent_messages().at(0)));
        ASSERT_FALSE(client_.receive(wire::Welcome{"a1", last_durable, limits, credit}, now_));
    }

    void add(int count) {
        for (int i = 0; i < count; ++i) client_.add(observation(laser_), now_);
    }

    std::optional<wire::LinkError> ack(std::uint64_t durable, std::uint64_t credit = kPlenty) {
        return client_.receive(wire::Ack{durable, durable, credit}, now_);
    }

    /// Returns the messages that it sends now.
    std::vector<wire::Message> sent_messages() {
        std::vector<wire::Message> messages;
        while (auto frame = client_.next_frame(now_)) {
            frame_bytes_.push_back(frame->size());
            messages.push_back(*wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes)));
        }
        return messages;
    }

    /// Returns the seqs of the scans that it sends now.
    std::vector<std::uint64_t> sent_seqs() {
        std::vector<std::uint64_t> seqs;
        for (const auto& message : sent_messages()) {
            if (const auto* batch = std::get_if<wire::ScanBatch>(&message)) {
                for (const Scan& scan : batch->scans) seqs.push_back(scan.seq);
            }
        }
        return seqs;
    }

    Time now_ = kStart;
    std::shared_ptr<const Sensor> laser_ = laser();
    ClientLink client_{options(), kStart};
    std::vector<std::size_t> frame_bytes_;
};

std::vector<std::uint64_t> from_to(std::uint64_t first, std::uint64_t last) {
    std::vector<std::uint64_t> seqs;
    for (std::uint64_t seq = first; seq <= last; ++seq) seqs.push_back(seq);
    return seqs;
}

TEST_F(ClientProtocolTest, SendsOnlyHelloBeforeTheWelcome) {
    EXPECT_TRUE(sent_messages().empty()) << "there is no link yet";
    client_.protocol.open("host:1", now_);
    const auto messages = sent_messages();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(std::get<wire::Hello>(messages[0]).robot, "r1");
    EXPECT_FALSE(client_.protocol.resumed_after());
}

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

TEST_F(ClientProtocolTest, DescribesASensorOncePerLinkBeforeItsFirstScan) {
    welcome();
    add(2);
    auto messages = sent_messages();
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_EQ(std::get<Sensor>(messages[0]), *laser_);
    EXPECT_EQ(std::get<wire::ScanBatch>(messages[1]).scans.size(), 2U);
    add(1);
    messages = sent_messages();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_TRUE(std::holds_alternative<wire::ScanBatch>(messages[0]));
    client_.protocol.close();
    welcome(3);
    add(1);
    EXPECT_TRUE(std::holds_alternative<Sensor>(sent_messages().at(0))) << "a new link needs all descriptions";
}

TEST_F(ClientProtocolTest, ChangedDescriptionIsSentBetweenItsScans) {
    welcome();
    add(2);
    client_.add(observation(laser(20.0)), now_);
    add(1);
    const auto messages = sent_messages();
    std::vector<std::string> names;
    for (const auto& message : messages) names.emplace_back(wire::name_of(message));
    EXPECT_EQ(names, (std::vector<std::string>{"sensor_description", "scan_batch", "sensor_description", "scan_batch",
                                               "sensor_description", "scan_batch"}));
}

TEST_F(ClientProtocolTest, WaitingScansShareFramesOfTheConfiguredSize) {
    welcome(0, 100 << 20);
    add(500);
    frame_bytes_.clear();
    EXPECT_EQ(sent_seqs(), from_to(1, 500));
    EXPECT_LT(frame_bytes_.size(), 20U);
    for (const std::size_t bytes : frame_bytes_) EXPECT_LE(bytes, options().batch_bytes_max);
}

TEST_F(ClientProtocolTest, NeverExceedsItsCredit) {
    std::mt19937 random(5);
    welcome(0, 5000);
    add(300);
    std::uint64_t credit = 5000;
    std::uint64_t durable = 0;
    std::deque<std::pair<std::uint64_t, std::size_t>> under_way; // last seq and bytes of each batch
    for (int round = 0; round < 10000 && durable < 300; ++round) {
        while (auto frame = client_.next_frame(now_)) {
            const auto message = *wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes));
            if (const auto* batch = std::get_if<wire::ScanBatch>(&message)) {
                under_way.emplace_back(batch->scans.back().seq, frame->size());
                std::size_t bytes = 0;
                for (const auto& [seq, size] : under_way) bytes += size;
                ASSERT_LE(bytes, credit);
            }
        }
        if (under_way.empty()) { // the credit was too small for even one scan
            credit = 5000;
        } else {
            durable += random() % (under_way.back().first - durable + 1);
            credit = random() % 6000;
        }
        ASSERT_FALSE(ack(durable, credit));
        while (!under_way.empty() && under_way.front().first <= durable) under_way.pop_front();
    }
    EXPECT_EQ(durable, 300U);
}

TEST_F(ClientProtocolTest, CreditCountsUncompressedBytes) {
    link::ClientProtocolOptions compressing = options();
    compressing.compress = true;
    ClientLink client{compressing, kStart};
    client.protocol.open("host:1", now_);
    ASSERT_TRUE(client.next_frame(now_));
    wire::Welcome welcome{"a1", 0, {}, 2000};
    welcome.zstd = true;
    ASSERT_FALSE(client.receive(welcome, now_));
    for (int i = 0; i < 10; ++i) client.add(observation(laser_), now_);
    std::size_t held = 0;
    std::size_t travelled = 0;
    while (const auto frame = client.next_frame(now_)) {
        const auto message = *wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes));
        if (std::holds_alternative<Sensor>(message)) continue;
        held += std::get<wire::CompressedScanBatch>(message).size + wire::kLengthPrefixBytes;
        travelled += frame->size();
    }
    EXPECT_LT(travelled, 200U);
    EXPECT_GT(held, 1000U);
    EXPECT_LE(held, 2000U);
}

TEST_F(ClientProtocolTest, WaitsWithoutCredit) {
    welcome(0, 0);
    add(1);
    EXPECT_TRUE(sent_seqs().empty());
    ASSERT_FALSE(ack(0, kPlenty));
    EXPECT_EQ(sent_seqs(), from_to(1, 1));
}

TEST_F(ClientProtocolTest, KeepsTheServersBatchLimits) {
    welcome(0, kPlenty, {2000, 4096, 3});
    add(7);
    for (const auto& message : sent_messages()) {
        const auto* batch = std::get_if<wire::ScanBatch>(&message);
        EXPECT_LE(batch ? batch->scans.size() : 0U, 3U);
    }
    for (const std::size_t bytes : frame_bytes_) EXPECT_LE(bytes, 2000 + wire::kLengthPrefixBytes);
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

TEST_F(ClientProtocolTest, NewProgramContinuesAfterTheServersScans) {
    welcome(41);
    EXPECT_EQ(client_.protocol.resumed_after(), 41U);
    add(2);
    EXPECT_EQ(sent_seqs(), from_to(42, 43));
}

TEST_F(ClientProtocolTest, ReconnectResendsScansThatAreNotDurable) {
    welcome();
    add(10);
    EXPECT_EQ(sent_seqs(), from_to(1, 10));
    ASSERT_FALSE(ack(4));
    client_.protocol.close();
    EXPECT_TRUE(sent_messages().empty());
    add(2);
    welcome(6); // the server had stored two more than it could acknowledge
    EXPECT_EQ(sent_seqs(), from_to(7, 12));
    EXPECT_EQ(client_.buffer.acknowledged(), 6U);
    EXPECT_EQ(client_.protocol.welcomes(), 2U);
}

TEST_F(ClientProtocolTest, LostAcknowledgedScansAreAFinalError) {
    welcome();
    add(10);
    sent_messages();
    ASSERT_FALSE(ack(8));
    client_.protocol.close();
    client_.protocol.open("host:1", now_);
    sent_messages();
    const auto failure = client_.receive(wire::Welcome{"a1", 5, {}, kPlenty}, now_);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("scans 6 to 8 are no longer in memory"));
    EXPECT_EQ(client_.protocol.lost_scans(), 3U);
}

TEST_F(ClientProtocolTest, RecreatedSessionIsAFinalError) {
    welcome();
    add(10);
    sent_messages();
    ASSERT_FALSE(ack(8));
    client_.protocol.close();
    client_.protocol.open("host:1", now_);
    sent_messages();
    const auto failure = client_.receive(wire::Welcome{"b2", 0, {}, kPlenty}, now_);
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

TEST_F(ClientProtocolTest, OlderAckOnlyUpdatesTheCredit) {
    welcome();
    add(3);
    sent_messages();
    ASSERT_FALSE(ack(2));
    ASSERT_FALSE(ack(1));
    EXPECT_EQ(client_.buffer.acknowledged(), 2U);
}

TEST_F(ClientProtocolTest, AnswersPingsAndPingsWhenIdle) {
    welcome();
    ASSERT_FALSE(client_.receive(wire::Ping{77}, now_));
    EXPECT_EQ(sent_messages(), (std::vector<wire::Message>{wire::Pong{77}}));
    now_ += 4999ms;
    EXPECT_TRUE(sent_messages().empty());
    EXPECT_EQ(client_.protocol.deadline(now_), now_ + 1ms);
    now_ += 1ms;
    EXPECT_TRUE(std::holds_alternative<wire::Ping>(sent_messages().at(0)));
    EXPECT_TRUE(sent_messages().empty()) << "one ping at a time";
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

TEST_F(ClientProtocolTest, SendsGoodbyeWhenAllScansAreDurable) {
    welcome();
    add(2);
    sent_messages();
    client_.protocol.end();
    EXPECT_TRUE(sent_messages().empty());
    ASSERT_FALSE(ack(1));
    EXPECT_FALSE(client_.protocol.is_done());
    ASSERT_FALSE(ack(2));
    EXPECT_TRUE(client_.protocol.is_done());
    EXPECT_TRUE(std::holds_alternative<wire::Goodbye>(sent_messages().at(0)));
    EXPECT_TRUE(client_.protocol.said_goodbye());
    now_ += 60s;
    EXPECT_TRUE(sent_messages().empty()) << "nothing follows the goodbye";
}

TEST_F(ClientProtocolTest, StallsOnlyWithWaitingScansUntilProgress) {
    EXPECT_EQ(client_.protocol.stalled_since(), kStart) << "the server was never reached";
    now_ += 5s;
    welcome();
    EXPECT_EQ(client_.protocol.stalled_since(), std::nullopt);
    now_ += 5s;
    add(2);
    EXPECT_EQ(client_.protocol.stalled_since(), now_);
    sent_messages();
    now_ += 5s;
    ASSERT_FALSE(ack(1));
    EXPECT_EQ(client_.protocol.stalled_since(), now_);
    const Time progress = now_;
    now_ += 5s;
    ASSERT_FALSE(ack(1));
    EXPECT_EQ(client_.protocol.stalled_since(), progress) << "a repeated ack is no progress";
    ASSERT_FALSE(ack(2));
    EXPECT_EQ(client_.protocol.stalled_since(), std::nullopt);
}

TEST(ClientProtocol, AnySplitOfTheServersBytesGivesTheSameResult) {
    std::string bytes;
    wire::encode(wire::Welcome{"a1", 5, {}, kPlenty}, bytes);
    wire::encode(wire::Ping{3}, bytes);
    wire::encode(wire::Ack{6, 6, kPlenty}, bytes);
    for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
        ClientLink client(options(), kStart);
        client.piece_bytes = piece;
        client.protocol.open("host:1", kStart);
        EXPECT_EQ(client.sent(kStart).size(), 1U);
        EXPECT_THAT(client.receive_bytes(bytes, kStart)->error.message, HasSubstr("acknowledged scan 6, only 5"))
            << piece;
        EXPECT_EQ(client.protocol.resumed_after(), 5U);
        EXPECT_EQ(client.sent(kStart), (std::vector<wire::Message>{wire::Pong{3}}));
    }
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
    ClientLink client(options(), kStart);
    client.protocol.open("host:1", now_, true);
    EXPECT_TRUE(client.receive_bytes("HTTP/1.1 400 Bad Request\r\n", now_)->retryable) << "on another server";
}

TEST_F(ClientProtocolTest, ServersScansWithoutAnEarlierRunAreAConflict) {
    auto fresh = options();
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

/// A server that loses its link at random and stores a random part of the received scans: at the end it has every scan
/// once.
TEST(ClientProtocol, ScansArriveOnceInOrderOverBrokenLinks) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        std::mt19937 random(seed);
        Time now = kStart;
        auto made = options();
        made.batch_bytes_max = 3'000;
        ClientLink robot(made, now, 20'000);
        const auto sensor = laser();
        constexpr std::uint64_t kScans = 200;
        std::uint64_t stored = 0;
        std::uint64_t taken = 0;
        for (int link = 0; !robot.protocol.is_done(); ++link) {
            ASSERT_LT(link, 1000);
            robot.protocol.open("host:1", now);
            ASSERT_TRUE(robot.next_frame(now));
            ASSERT_FALSE(robot.receive(wire::Welcome{"a1", stored, {}, 8000}, now));
            for (std::uint64_t steps = random() % 30; steps > 0; --steps) {
                while (taken < kScans && robot.buffer.has_room()) {
                    robot.add(observation(sensor), now);
                    if (++taken == kScans) robot.protocol.end();
                }
                if (auto frame = robot.next_frame(now)) {
                    const auto message = *wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes));
                    const auto* batch = std::get_if<wire::ScanBatch>(&message);
                    if (batch && random() % 10 != 0) { // otherwise it is lost with the link
                        for (const Scan& scan : batch->scans) ASSERT_EQ(scan.seq, ++stored);
                    } else if (batch) {
                        break;
                    }
                }
                if (random() % 3 == 0) {
                    ASSERT_FALSE(robot.receive(wire::Ack{stored, stored, 8000}, now));
                }
            }
            robot.protocol.close();
        }
        EXPECT_EQ(stored, kScans);
        EXPECT_EQ(robot.buffer.acknowledged(), kScans);
    }
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

TEST_F(ClientProtocolTest, SendsRequestsBeforeScansAndPassesOnTheReply) {
    std::vector<link::Reply> replies;
    EXPECT_TRUE(client_.protocol.ask(wire::PlanRequest{.goal = {1.0, 2.0}},
                                     [&](const link::Reply& one) { replies.push_back(one); }));
    welcome();
    add(1);
    const auto messages = sent_messages();
    ASSERT_EQ(messages.size(), 3U);
    const auto request = std::get<wire::PlanRequest>(messages[0]);
    EXPECT_EQ(request.goal, (Point2{1.0, 2.0}));
    EXPECT_TRUE(replies.empty());
    const wire::PlanReply reply{request.id, 5, Error{Errc::kNoPath, "a wall"}};
    EXPECT_FALSE(client_.receive(reply, now_));
    ASSERT_EQ(replies.size(), 1U);
    EXPECT_EQ(std::get<wire::PlanReply>(replies[0]), reply);
    EXPECT_EQ(sent_seqs(), from_to(1, 0)) << "all messages are sent";
}

TEST_F(ClientProtocolTest, UnexpectedReplyEndsTheLink) {
    welcome();
    const auto failure = client_.receive(wire::PlanReply{1, 5, Error{Errc::kNoPath, "a wall"}}, now_);
    ASSERT_TRUE(failure);
    EXPECT_THAT(failure->error.message, HasSubstr("unexpected plan_reply"));
}

} // namespace
} // namespace scanloom::robot

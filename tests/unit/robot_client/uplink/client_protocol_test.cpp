#include "tests/unit/robot_client/uplink/client_protocol_fixture.hpp"

#include <gmock/gmock.h>

#include <random>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

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
    client_.add(uniform_scan(half_turn_laser(20.0)), now_);
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
    for (const std::size_t bytes : frame_bytes_) EXPECT_LE(bytes, client_options().batch_bytes_max);
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
    link::ClientProtocolOptions compressing = client_options();
    compressing.compress = true;
    ClientLink client{compressing, kStart};
    client.protocol.open("host:1", now_);
    ASSERT_TRUE(client.next_frame(now_));
    wire::Welcome welcome{"a1", 0, {}, 2000};
    welcome.zstd = true;
    ASSERT_FALSE(client.receive(welcome, now_));
    for (int i = 0; i < 10; ++i) client.add(uniform_scan(laser_), now_);
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

TEST_F(ClientProtocolTest, AnySplitOfTheServersBytesGivesTheSameResult) {
    std::string bytes;
    wire::encode(wire::Welcome{"a1", 5, {}, kPlenty}, bytes);
    wire::encode(wire::Ping{3}, bytes);
    wire::encode(wire::Ack{6, 6, kPlenty}, bytes);
    for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
        ClientLink client(client_options(), kStart);
        client.piece_bytes = piece;
        client.protocol.open("host:1", kStart);
        EXPECT_EQ(client.sent(kStart).size(), 1U);
        EXPECT_THAT(client.receive_bytes(bytes, kStart)->error.message, HasSubstr("acknowledged scan 6, only 5"))
            << piece;
        EXPECT_EQ(client.protocol.resumed_after(), 5U);
        EXPECT_EQ(client.sent(kStart), (std::vector<wire::Message>{wire::Pong{3}}));
    }
}

/// A server that loses its link at random and stores a random part of the received scans: at the end it has every scan
/// once.
TEST_F(ClientProtocolTest, ScansArriveOnceInOrderOverBrokenLinks) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        std::mt19937 random(seed);
        Time now = kStart;
        auto made = client_options();
        made.batch_bytes_max = 3'000;
        ClientLink robot(made, now, 20'000);
        const auto sensor = half_turn_laser();
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
                    robot.add(uniform_scan(sensor), now);
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

} // namespace
} // namespace scanloom::robot

#include "load/core/measured_client.hpp"

#include "common/wire/frame_decoder.hpp"
#include "tests/support/random_scans.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>

namespace scanloom::load {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kRate = 10.0;
constexpr Micros kPeriod = kSecond / 10;
constexpr std::size_t kCourseScans = 5;
constexpr Micros kPingAfter = 5 * kSecond;
constexpr Micros kSilenceMax = 15 * kSecond;

/// One robot and the messages of a server, at times given by the test.
class MeasuredClientTest : public testing::Test {
protected:
    MeasuredClientTest() { set_up(1); }

    void set_up(std::uint32_t batch, std::size_t first_scan = 0) {
        scans_ = testing_support::random_scans(3, 1, kCourseScans);
        workload_ = make_workload(testing_support::small_laser(), scans_, kRate, batch);
        workload_.schedule = Schedule(1, kRate);
        client_ = std::make_unique<MeasuredClient>(RobotPlan{0, "load-1-0", "r0", first_scan}, workload_, hello_);
    }

    /// Returns the messages that the robot sends at `now`.
    std::vector<wire::Message> messages_at(Micros now) {
        std::string bytes;
        client_->write(bytes, now, *figures_);
        wire::FrameDecoder decoder(wire::kFrameBytesMax);
        const auto room = decoder.prepare(bytes.size());
        std::ranges::copy(std::as_bytes(std::span(bytes)), room.begin());
        decoder.commit(bytes.size());
        std::vector<wire::Message> messages;
        for (auto body = decoder.next(); body && *body; body = decoder.next()) {
            messages.push_back(*wire::decode(**body));
        }
        return messages;
    }

    /// Returns the scans that the robot sends at `now`.
    std::vector<Scan> sent(Micros now) {
        std::vector<Scan> scans;
        for (const auto& message : messages_at(now)) {
            const auto* batch = std::get_if<wire::ScanBatch>(&message);
            if (batch) scans.insert(scans.end(), batch->scans.begin(), batch->scans.end());
        }
        return scans;
    }

    std::vector<std::uint64_t> sent_seqs(Micros now) {
        std::vector<std::uint64_t> seqs;
        for (const auto& scan : sent(now)) seqs.push_back(scan.seq);
        return seqs;
    }

    void link(std::uint64_t durable = 0, Micros now = 0, std::uint64_t credit = 1 << 20) {
        client_->open("host:1", now);
        static_cast<void>(messages_at(now));
        EXPECT_FALSE(receive(wire::Welcome{"5e55", durable, {}, credit, false}, now));
    }

    std::optional<wire::LinkError> receive(const wire::Message& message, Micros now) {
        std::string frame;
        wire::encode(message, frame);
        std::ranges::copy(std::as_bytes(std::span(frame)), client_->prepare(frame.size()).begin());
        return client_->on_bytes(frame.size(), now, *figures_);
    }
    void acknowledge(std::uint64_t seq, Micros now, std::uint64_t credit = 1 << 20) {
        EXPECT_FALSE(receive(wire::Ack{seq, seq, credit}, now));
    }

    std::vector<Scan> scans_;
    Workload workload_;
    wire::Hello hello_{.client = "scanloom-load"};
    std::unique_ptr<FleetFigures> figures_ = std::make_unique<FleetFigures>();
    std::unique_ptr<MeasuredClient> client_;
};

TEST_F(MeasuredClientTest, SendsHelloSensorAndRepeatedScans) {
    client_->open("host:1", 0);
    client_->due(7, 0);
    auto messages = messages_at(0);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(std::get<wire::Hello>(messages[0]).session, "load-1-0");
    EXPECT_EQ(std::get<wire::Hello>(messages[0]).robot, "r0");
    EXPECT_THAT(messages_at(1), IsEmpty()); // nothing before the welcome message

    EXPECT_FALSE(receive(wire::Welcome{"5e55", 0, {}, 1 << 20, false}, 2));
    messages = messages_at(3);
    ASSERT_EQ(messages.size(), 8U);
    EXPECT_EQ(std::get<Sensor>(messages[0]), testing_support::small_laser());
    for (std::uint64_t seq = 1; seq <= 7; ++seq) {
        Scan expected = scans_[std::array{0U, 1U, 2U, 3U, 4U, 3U, 2U}.at(seq - 1)];
        expected.seq = seq;
        expected.stamp = static_cast<double>(seq - 1) / kRate;
        EXPECT_THAT(std::get<wire::ScanBatch>(messages[seq]).scans, ElementsAre(expected));
    }
    EXPECT_EQ(figures_->scans_sent, 7U);
}

TEST_F(MeasuredClientTest, BeginsAtThePlannedScan) {
    set_up(1, 3);
    link();
    client_->due(3, 0);
    const auto scans = sent(0);
    ASSERT_EQ(scans.size(), 3U);
    EXPECT_EQ(scans[0].ranges, scans_[3].ranges);
    EXPECT_EQ(scans[2].ranges, scans_[3].ranges);
}

TEST_F(MeasuredClientTest, ScansAreBatchedExceptTheLastOnes) {
    set_up(3);
    link();
    client_->due(2, 0);
    EXPECT_THAT(sent_seqs(0), IsEmpty());
    client_->due(7, 0);
    EXPECT_THAT(sent_seqs(0), ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_EQ(figures_->frames_out, 2U);
    client_->end();
    EXPECT_THAT(sent_seqs(0), ElementsAre(7));
}

TEST_F(MeasuredClientTest, UnacknowledgedBytesStayWithinTheCredit) {
    link(0, 0, 350);
    client_->due(10, 0);
    const auto first = sent_seqs(0).size();
    EXPECT_EQ(first, 2U); // a frame has about 140 bytes
    acknowledge(1, 1, 350);
    EXPECT_THAT(sent_seqs(1), ElementsAre(3));
    acknowledge(3, 2);
    EXPECT_EQ(sent_seqs(2).size(), 7U);
}

TEST_F(MeasuredClientTest, ReconnectResendsScansThatAreNotDurable) {
    link();
    client_->due(6, 0);
    const auto before = sent(0);
    acknowledge(2, 1);
    client_->close(*figures_);
    EXPECT_EQ(figures_->linked, 0U);

    link(4, 10); // two more scans had arrived
    EXPECT_EQ(client_->acknowledged(), 4U);
    const auto again = sent(10);
    ASSERT_EQ(again.size(), 2U);
    EXPECT_EQ(again[0], before[4]);
    EXPECT_EQ(again[1], before[5]);
    EXPECT_EQ(figures_->scans_sent, 6U);
    EXPECT_EQ(figures_->scans_resent, 2U);
    EXPECT_EQ(figures_->links, 2U);
    EXPECT_EQ(figures_->greeted, 1U);
    acknowledge(6, 11);
    EXPECT_EQ(figures_->scans_acknowledged, 6U);
    EXPECT_EQ(figures_->from_intended.count(), 6U);
}

TEST_F(MeasuredClientTest, LatencyOfAStalledServerCountsFromTheIntendedTime) {
    link(0, 0, 180); // one frame at a time
    client_->begin(0);
    client_->due(1, 0);
    EXPECT_THAT(sent_seqs(0), ElementsAre(1));
    client_->due(11, 0);
    EXPECT_THAT(sent_seqs(kSecond), IsEmpty());
    for (std::uint64_t seq = 1; seq <= 11; ++seq) { // after one second, the server acknowledges all scans immediately
        acknowledge(seq, kSecond, 180);
        static_cast<void>(sent_seqs(kSecond));
    }
    EXPECT_EQ(figures_->from_intended.count(), 11U);
    EXPECT_NEAR(static_cast<double>(figures_->from_intended.percentile(50)), 5 * kPeriod, kPeriod * 0.01);
    EXPECT_EQ(figures_->from_intended.max(), kSecond);
    EXPECT_EQ(figures_->from_sending.percentile(90), 0); // the result of a tool that waits for the server
    EXPECT_NEAR(static_cast<double>(figures_->waiting_to_send.percentile(99)), 9 * kPeriod, kPeriod * 0.01);
}

TEST_F(MeasuredClientTest, TimesCountFromTheStart) {
    link();
    client_->begin(7 * kSecond);
    client_->due(2, 0);
    EXPECT_EQ(sent_seqs(7 * kSecond + kPeriod).size(), 2U);
    acknowledge(2, 7 * kSecond + kPeriod + 500);
    EXPECT_EQ(figures_->from_intended.percentile(50), 500);
    EXPECT_EQ(figures_->from_intended.max(), kPeriod + 500);
    EXPECT_EQ(figures_->last_ack, 7 * kSecond + kPeriod + 500);
}

TEST_F(MeasuredClientTest, ForgottenAcknowledgedScansAreLost) {
    link();
    client_->due(6, 0);
    static_cast<void>(sent(0));
    acknowledge(5, 1);
    client_->close(*figures_);
    client_->open("host:1", 2);
    static_cast<void>(messages_at(2));
    const auto failure = receive(wire::Welcome{"5e55", 3, {}, 1 << 20, false}, 2);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("holds 3 scans of this robot but had acknowledged 5"));
    EXPECT_EQ(figures_->scans_lost, 2U);
}

TEST_F(MeasuredClientTest, RecreatedSessionHasLostAllScans) {
    link();
    client_->due(6, 0);
    static_cast<void>(sent(0));
    acknowledge(5, 1);
    client_->close(*figures_);
    client_->open("host:1", 2);
    static_cast<void>(messages_at(2));
    EXPECT_TRUE(receive(wire::Welcome{"07he4", 5, {}, 1 << 20, false}, 2));
    EXPECT_EQ(figures_->scans_lost, 5U);
}

TEST_F(MeasuredClientTest, UnsentScansMustNotBeStoredOrAcknowledged) {
    client_->open("host:1", 0);
    static_cast<void>(messages_at(0));
    const auto held = receive(wire::Welcome{"5e55", 1, {}, 1 << 20, false}, 0);
    ASSERT_TRUE(held);
    EXPECT_THAT(held->error.message, HasSubstr("another program uses the same"));

    set_up(1);
    link();
    client_->due(3, 0);
    static_cast<void>(sent(0));
    const auto acknowledged = receive(wire::Ack{4, 4, 1 << 20}, 1);
    ASSERT_TRUE(acknowledged);
    EXPECT_FALSE(acknowledged->retryable);
    EXPECT_EQ(figures_->scans_acknowledged, 0U);
}

TEST_F(MeasuredClientTest, AnswersPingsAndSaysGoodbyeAfterTheLastAcknowledgement) {
    link();
    client_->due(1, 0);
    client_->end();
    static_cast<void>(messages_at(0));
    EXPECT_FALSE(receive(wire::Ping{42}, 1));
    EXPECT_THAT(messages_at(1), ElementsAre(wire::Message(wire::Pong{42})));
    EXPECT_FALSE(client_->is_done());
    acknowledge(1, 2);
    EXPECT_TRUE(client_->is_done());
    const auto last = messages_at(2);
    ASSERT_EQ(last.size(), 1U);
    EXPECT_TRUE(std::holds_alternative<wire::Goodbye>(last[0]));
    EXPECT_THAT(messages_at(3), IsEmpty());
}

TEST_F(MeasuredClientTest, QuietLinkIsPingedAndDeadLinkDetected) {
    link();
    EXPECT_THAT(messages_at(0), ElementsAre(wire::Message(testing_support::small_laser()))) << "also without scans";
    EXPECT_THAT(messages_at(kPingAfter - 1), IsEmpty());
    EXPECT_EQ(messages_at(kPingAfter).size(), 1U);
    EXPECT_FALSE(client_->check(kSilenceMax - 1));
    EXPECT_TRUE(client_->check(kSilenceMax));
    EXPECT_FALSE(receive(wire::Pong{0}, kPingAfter + 1));
    EXPECT_FALSE(client_->check(kPingAfter + kSilenceMax));
}

TEST_F(MeasuredClientTest, MissingAcknowledgementsAreDetectedWhileSending) {
    link();
    for (Micros now = 0; now < kSilenceMax; now += kPeriod) {
        client_->due(static_cast<std::uint64_t>(now / kPeriod) + 1, now);
        static_cast<void>(sent(now));
        EXPECT_FALSE(client_->check(now)) << now;
    }
    EXPECT_TRUE(client_->check(kSilenceMax));
}

TEST_F(MeasuredClientTest, UnscheduledRobotSendsWithinTheCreditUntilTheEnd) {
    workload_.schedule.reset();
    link(0, 0, 1000);
    client_->due(MeasuredClient::kEndless, 0);
    const auto first = sent_seqs(0).size();
    EXPECT_GT(first, 3U);
    acknowledge(first, 100, 1000);
    EXPECT_EQ(sent_seqs(100).size(), first);
    client_->end();
    EXPECT_THAT(sent_seqs(100), IsEmpty());
    acknowledge(2 * first, 200, 1000);
    EXPECT_TRUE(client_->is_done());
    EXPECT_EQ(figures_->from_sending.max(), 100);
    EXPECT_EQ(figures_->from_intended.count(), 0U) << "scans have no intended time";
}

} // namespace
} // namespace scanloom::load

#include "robot_client/uplink/conversation.hpp"

#include "common/wire/frame_decoder.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using Time = Conversation::Time;

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

ConversationOptions options() {
    ConversationOptions made;
    made.hello.robot = "r1";
    made.hello.session = "s1";
    return made;
}

/// A conversation and what it says.
class ConversationTest : public testing::Test {
protected:
    void welcome(std::uint64_t last_durable = 0, std::uint64_t credit = kPlenty, wire::Limits limits = {}) {
        conversation_.open(now_);
        ASSERT_TRUE(std::holds_alternative<wire::Hello>(said().at(0)));
        ASSERT_FALSE(conversation_.receive(wire::Welcome{"a1", last_durable, limits, credit}, now_));
    }

    void add(int count) {
        for (int i = 0; i < count; ++i) conversation_.add(observation(laser_), now_);
    }

    std::optional<wire::LinkError> ack(std::uint64_t durable, std::uint64_t credit = kPlenty) {
        return conversation_.receive(wire::Ack{durable, durable, credit}, now_);
    }

    /// Everything it has to say now.
    std::vector<wire::Message> said() {
        std::vector<wire::Message> messages;
        while (auto frame = conversation_.next_frame(now_)) {
            frame_bytes_.push_back(frame->size());
            messages.push_back(*wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes)));
        }
        return messages;
    }

    /// The seqs of all scans it has to say now.
    std::vector<std::uint64_t> said_seqs() {
        std::vector<std::uint64_t> seqs;
        for (const auto& message : said()) {
            if (const auto* batch = std::get_if<wire::ScanBatch>(&message)) {
                for (const Scan& scan : batch->scans) seqs.push_back(scan.seq);
            }
        }
        return seqs;
    }

    Time now_ = kStart;
    std::shared_ptr<const Sensor> laser_ = laser();
    Conversation conversation_{options(), kStart};
    std::vector<std::size_t> frame_bytes_;
};

std::vector<std::uint64_t> from_to(std::uint64_t first, std::uint64_t last) {
    std::vector<std::uint64_t> seqs;
    for (std::uint64_t seq = first; seq <= last; ++seq) seqs.push_back(seq);
    return seqs;
}

TEST_F(ConversationTest, SaysHelloFirstAndNothingElseBeforeTheWelcome) {
    EXPECT_TRUE(said().empty()) << "there is no link yet";
    conversation_.open(now_);
    const auto messages = said();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(std::get<wire::Hello>(messages[0]).robot, "r1");
    EXPECT_FALSE(conversation_.resumed_after());
}

/// An earlier link's hello may arrive late; another program comes back again and again.
TEST_F(ConversationTest, GivesUpOnlyWhenItIsReplacedAgainAndAgain) {
    const wire::LinkError replaced{{Errc::kReplaced, "robot 'r1' connected again"}, false};
    const auto end_of_link = [&] {
        welcome();
        const auto failure = conversation_.receive(replaced, now_);
        conversation_.close();
        return failure.value();
    };
    for (int n = 0; n < 4; ++n) { // seldom
        EXPECT_TRUE(end_of_link().retryable);
        now_ += Replacements::kWithin;
    }
    EXPECT_TRUE(end_of_link().retryable);
    now_ += 1s;
    EXPECT_TRUE(end_of_link().retryable);
    now_ += 1s;
    const auto last = end_of_link();
    EXPECT_FALSE(last.retryable);
    EXPECT_THAT(last.error.message, HasSubstr("another program uses the same --robot and --session"));
}

TEST_F(ConversationTest, DescribesASensorBeforeItsFirstScanAndOnceALink) {
    welcome();
    add(2);
    auto messages = said();
    ASSERT_EQ(messages.size(), 2U);
    EXPECT_EQ(std::get<Sensor>(messages[0]), *laser_);
    EXPECT_EQ(std::get<wire::ScanBatch>(messages[1]).scans.size(), 2U);
    add(1);
    messages = said();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_TRUE(std::holds_alternative<wire::ScanBatch>(messages[0]));
    conversation_.close();
    welcome(3);
    add(1);
    EXPECT_TRUE(std::holds_alternative<Sensor>(said().at(0))) << "a new link knows no sensors";
}

TEST_F(ConversationTest, ADescriptionThatChangesIsSaidBetweenTheScansItDivides) {
    welcome();
    add(2);
    conversation_.add(observation(laser(20.0)), now_);
    add(1);
    const auto messages = said();
    std::vector<std::string> names;
    for (const auto& message : messages) names.emplace_back(wire::name_of(message));
    EXPECT_EQ(names, (std::vector<std::string>{"sensor_description", "scan_batch", "sensor_description", "scan_batch",
                                               "sensor_description", "scan_batch"}));
}

TEST_F(ConversationTest, ScansWaitingTogetherShareFramesOfAboutTheWantedSize) {
    welcome(0, 100 << 20);
    add(500);
    frame_bytes_.clear();
    EXPECT_EQ(said_seqs(), from_to(1, 500));
    EXPECT_LT(frame_bytes_.size(), 20U);
    for (const std::size_t bytes : frame_bytes_) EXPECT_LE(bytes, options().batch_bytes_max);
}

TEST_F(ConversationTest, NeverHasMoreThanItsCreditUnderWay) {
    std::mt19937 random(5);
    welcome(0, 5000);
    add(300);
    std::uint64_t credit = 5000;
    std::uint64_t durable = 0;
    std::deque<std::pair<std::uint64_t, std::size_t>> under_way; // last seq and bytes of each batch
    for (int round = 0; round < 10000 && durable < 300; ++round) {
        while (auto frame = conversation_.next_frame(now_)) {
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

TEST_F(ConversationTest, CreditIsOfWhatTheBatchesHoldNotOfWhatTravels) {
    ConversationOptions compressing = options();
    compressing.compress = true;
    Conversation conversation{compressing, kStart};
    conversation.open(now_);
    ASSERT_TRUE(conversation.next_frame(now_));
    wire::Welcome welcome{"a1", 0, {}, 2000};
    welcome.zstd = true;
    ASSERT_FALSE(conversation.receive(welcome, now_));
    for (int i = 0; i < 10; ++i) conversation.add(observation(laser_), now_);
    std::size_t held = 0;
    std::size_t travelled = 0;
    while (const auto frame = conversation.next_frame(now_)) {
        const auto message = *wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes));
        if (std::holds_alternative<Sensor>(message)) continue;
        held += std::get<wire::CompressedScanBatch>(message).size + wire::kLengthPrefixBytes;
        travelled += frame->size();
    }
    EXPECT_LT(travelled, 200U);
    EXPECT_GT(held, 1000U);
    EXPECT_LE(held, 2000U);
}

TEST_F(ConversationTest, WithoutCreditItWaits) {
    welcome(0, 0);
    add(1);
    EXPECT_TRUE(said_seqs().empty());
    ASSERT_FALSE(ack(0, kPlenty));
    EXPECT_EQ(said_seqs(), from_to(1, 1));
}

TEST_F(ConversationTest, KeepsToTheServersBatchLimits) {
    welcome(0, kPlenty, {2000, 4096, 3});
    add(7);
    for (const auto& message : said()) {
        const auto* batch = std::get_if<wire::ScanBatch>(&message);
        EXPECT_LE(batch ? batch->scans.size() : 0U, 3U);
    }
    for (const std::size_t bytes : frame_bytes_) EXPECT_LE(bytes, 2000 + wire::kLengthPrefixBytes);
}

TEST_F(ConversationTest, AScanTheServerWillNotTakeIsAFinalError) {
    welcome(0, kPlenty, {kPlenty, 100, 3});
    add(1);
    EXPECT_TRUE(said_seqs().empty());
    const auto failure = conversation_.check(now_);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("scan 1 has 180 beams, the server takes at most 100"));
}

TEST_F(ConversationTest, AFreshProgramContinuesBehindTheServersScans) {
    welcome(41);
    EXPECT_EQ(conversation_.resumed_after(), 41U);
    add(2);
    EXPECT_EQ(said_seqs(), from_to(42, 43));
}

TEST_F(ConversationTest, AfterAReconnectItResendsWhatWasNotDurable) {
    welcome();
    add(10);
    EXPECT_EQ(said_seqs(), from_to(1, 10));
    ASSERT_FALSE(ack(4));
    conversation_.close();
    EXPECT_TRUE(said().empty());
    add(2);
    welcome(6); // the server had stored two more than it could acknowledge
    EXPECT_EQ(said_seqs(), from_to(7, 12));
    EXPECT_EQ(conversation_.acknowledged(), 6U);
    EXPECT_EQ(conversation_.welcomes(), 2U);
}

TEST_F(ConversationTest, AServerThatLostAcknowledgedScansIsAFinalError) {
    welcome();
    add(10);
    said();
    ASSERT_FALSE(ack(8));
    conversation_.close();
    conversation_.open(now_);
    said();
    const auto failure = conversation_.receive(wire::Welcome{"a1", 5, {}, kPlenty}, now_);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("scans 6 to 8 are no longer in memory"));
}

TEST_F(ConversationTest, ASessionMadeAnewMeanwhileIsAFinalError) {
    welcome();
    add(10);
    said();
    ASSERT_FALSE(ack(8));
    conversation_.close();
    conversation_.open(now_);
    said();
    const auto failure = conversation_.receive(wire::Welcome{"b2", 0, {}, kPlenty}, now_);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(failure->retryable);
    EXPECT_THAT(failure->error.message, HasSubstr("made anew"));
}

TEST_F(ConversationTest, TheServersErrorsEndTheLinkAsTheySay) {
    welcome();
    for (const bool retryable : {true, false}) {
        const wire::LinkError said_by_server{{Errc::kConflict, "cell_size is 0.05 there"}, retryable};
        EXPECT_EQ(conversation_.receive(said_by_server, now_), said_by_server);
    }
    EXPECT_TRUE(conversation_.receive(wire::Goodbye{"restarting"}, now_)->retryable);
}

TEST_F(ConversationTest, FramesOutOfPlaceEndTheLink) {
    conversation_.open(now_);
    EXPECT_THAT(conversation_.receive(wire::Ack{}, now_)->error.message, HasSubstr("unexpected ack"));
    EXPECT_TRUE(conversation_.receive(wire::Welcome{}, now_)) << "before the hello";
    welcome();
    EXPECT_TRUE(conversation_.receive(wire::Welcome{}, now_)) << "a second welcome";
    EXPECT_TRUE(conversation_.receive(wire::Hello{}, now_));
    EXPECT_TRUE(conversation_.receive(wire::ScanBatch{}, now_));
    EXPECT_THAT(ack(1)->error.message, HasSubstr("acknowledged scan 1, only 0 were sent"));
    EXPECT_FALSE(conversation_.receive(wire::Correction{}, now_));
}

TEST_F(ConversationTest, AnAckThatFallsBackIsReadForItsCreditOnly) {
    welcome();
    add(3);
    said();
    ASSERT_FALSE(ack(2));
    ASSERT_FALSE(ack(1));
    EXPECT_EQ(conversation_.acknowledged(), 2U);
}

TEST_F(ConversationTest, AnswersPingsAndPingsInSilence) {
    welcome();
    ASSERT_FALSE(conversation_.receive(wire::Ping{77}, now_));
    EXPECT_EQ(said(), (std::vector<wire::Message>{wire::Pong{77}}));
    now_ += 4999ms;
    EXPECT_TRUE(said().empty());
    EXPECT_EQ(conversation_.deadline(now_), now_ + 1ms);
    now_ += 1ms;
    EXPECT_TRUE(std::holds_alternative<wire::Ping>(said().at(0)));
    EXPECT_TRUE(said().empty()) << "one ping at a time";
}

TEST_F(ConversationTest, ASilentLinkIsDeadAndAnyFrameKeepsItAlive) {
    welcome();
    now_ += 14s;
    EXPECT_FALSE(conversation_.check(now_));
    ASSERT_FALSE(conversation_.receive(wire::Pong{1}, now_));
    now_ += 14s;
    EXPECT_FALSE(conversation_.check(now_));
    now_ += 1s;
    ASSERT_TRUE(conversation_.check(now_));
    EXPECT_TRUE(conversation_.check(now_)->retryable);
    EXPECT_THAT(conversation_.check(now_)->error.message, HasSubstr("nothing came from the server for 15 s"));
}

TEST_F(ConversationTest, AHelloWithoutAnswerIsADeadLink) {
    conversation_.open(now_);
    said();
    EXPECT_EQ(conversation_.deadline(now_), kStart + 10s);
    EXPECT_FALSE(conversation_.check(now_ + 9999ms));
    EXPECT_THAT(conversation_.check(now_ + 10s)->error.message, HasSubstr("did not answer the hello within 10 s"));
}

TEST_F(ConversationTest, SaysGoodbyeOnceEverythingIsDurable) {
    welcome();
    add(2);
    said();
    conversation_.end();
    EXPECT_TRUE(said().empty());
    ASSERT_FALSE(ack(1));
    EXPECT_FALSE(conversation_.is_done());
    ASSERT_FALSE(ack(2));
    EXPECT_TRUE(conversation_.is_done());
    EXPECT_TRUE(std::holds_alternative<wire::Goodbye>(said().at(0)));
    EXPECT_TRUE(conversation_.said_goodbye());
    now_ += 60s;
    EXPECT_TRUE(said().empty()) << "goodbye is the last word";
}

TEST_F(ConversationTest, StallsOnlyWhileSomethingWaitsAndProgressEndsIt) {
    EXPECT_EQ(conversation_.stalled_since(), kStart) << "the server was never reached";
    now_ += 5s;
    welcome();
    EXPECT_EQ(conversation_.stalled_since(), std::nullopt);
    now_ += 5s;
    add(2);
    EXPECT_EQ(conversation_.stalled_since(), now_);
    said();
    now_ += 5s;
    ASSERT_FALSE(ack(1));
    EXPECT_EQ(conversation_.stalled_since(), now_);
    const Time progress = now_;
    now_ += 5s;
    ASSERT_FALSE(ack(1));
    EXPECT_EQ(conversation_.stalled_since(), progress) << "an ack that says nothing new is no progress";
    ASSERT_FALSE(ack(2));
    EXPECT_EQ(conversation_.stalled_since(), std::nullopt);
}

/// A server that loses its link at random and keeps a random part of what reached it: in the end it has every scan
/// once.
TEST(Conversation, EveryScanArrivesOnceAndInOrderHoweverLinksBreak) {
    for (unsigned seed = 0; seed < 200; ++seed) {
        std::mt19937 random(seed);
        Time now = kStart;
        auto made = options();
        made.buffer_bytes_max = 20'000;
        made.batch_bytes_max = 3'000;
        Conversation robot(made, now);
        const auto sensor = laser();
        constexpr std::uint64_t kScans = 200;
        std::uint64_t stored = 0;
        std::uint64_t taken = 0;
        for (int link = 0; !robot.is_done(); ++link) {
            ASSERT_LT(link, 1000);
            robot.open(now);
            ASSERT_TRUE(robot.next_frame(now));
            ASSERT_FALSE(robot.receive(wire::Welcome{"a1", stored, {}, 8000}, now));
            for (std::uint64_t steps = random() % 30; steps > 0; --steps) {
                while (taken < kScans && robot.has_room()) {
                    robot.add(observation(sensor), now);
                    if (++taken == kScans) robot.end();
                }
                if (auto frame = robot.next_frame(now)) {
                    const auto message = *wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes));
                    const auto* batch = std::get_if<wire::ScanBatch>(&message);
                    if (batch && random() % 10 != 0) { // else it is lost with the link
                        for (const Scan& scan : batch->scans) ASSERT_EQ(scan.seq, ++stored);
                    } else if (batch) {
                        break;
                    }
                }
                if (random() % 3 == 0) {
                    ASSERT_FALSE(robot.receive(wire::Ack{stored, stored, 8000}, now));
                }
            }
            robot.close();
        }
        EXPECT_EQ(stored, kScans);
        EXPECT_EQ(robot.acknowledged(), kScans);
    }
}

TEST_F(ConversationTest, AServersTextIsShownWithoutItsControlCharacters) {
    welcome();
    const auto refused = conversation_.receive(wire::LinkError{{Errc::kConflict, "no\x1b[2J\xc2\x9b!"}, false}, now_);
    ASSERT_TRUE(refused);
    EXPECT_EQ(*refused, (wire::LinkError{{Errc::kConflict, R"(no\x1b[2J\xc2\x9b!)"}, false}));
    const auto left = conversation_.receive(wire::Goodbye{std::string(5'000, '\a')}, now_);
    ASSERT_TRUE(left);
    EXPECT_THAT(left->error.message, testing::StartsWith(R"(the server said goodbye: \x07\x07)"));
    EXPECT_LT(left->error.message.size(), 600U);
}

TEST_F(ConversationTest, AServerThatDoesNotSayWhyIsSpokenFor) {
    welcome();
    EXPECT_EQ(conversation_.receive(wire::LinkError{{Errc::kConflict, ""}, false}, now_)->error.message,
              "the server ended the link with the error conflict and did not say why");
    EXPECT_EQ(conversation_.receive(wire::Goodbye{}, now_)->error.message, "the server said goodbye without a reason");
}

TEST_F(ConversationTest, AsksBeforeItSendsScansAndHandsOverTheReply) {
    std::vector<Reply> replies;
    EXPECT_TRUE(
        conversation_.ask(wire::PlanRequest{.goal = {1.0, 2.0}}, [&](const Reply& one) { replies.push_back(one); }));
    welcome();
    add(1);
    const auto messages = said();
    ASSERT_EQ(messages.size(), 3U);
    const auto request = std::get<wire::PlanRequest>(messages[0]);
    EXPECT_EQ(request.goal, (Point2{1.0, 2.0}));
    EXPECT_TRUE(replies.empty());
    const wire::PlanReply reply{request.id, 5, Error{Errc::kNoPath, "a wall"}};
    EXPECT_FALSE(conversation_.receive(reply, now_));
    ASSERT_EQ(replies.size(), 1U);
    EXPECT_EQ(std::get<wire::PlanReply>(replies[0]), reply);
    EXPECT_EQ(said_seqs(), from_to(1, 0)) << "all is said";
}

TEST_F(ConversationTest, AReplyThatNobodyAskedForIsAFaultOfTheServer) {
    welcome();
    const auto failure = conversation_.receive(wire::PlanReply{1, 5, Error{Errc::kNoPath, "a wall"}}, now_);
    ASSERT_TRUE(failure);
    EXPECT_THAT(failure->error.message, HasSubstr("unexpected plan_reply"));
}

} // namespace
} // namespace scanloom::robot

#include "tests/unit/robot_client/uplink/client_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Batching and compression of scans.
namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class Batching : public testing::Test {
protected:
    void begin(std::chrono::milliseconds delay, bool compress = false, bool server_understands = true) {
        auto options = client_options();
        options.batch_delay = delay;
        options.batch_bytes_max = 4000;
        options.compress = compress;
        client_.emplace(options, now_);
        server_understands_ = server_understands;
        connect();
    }

    void connect(std::uint64_t durable = 0) {
        client_->protocol.open("host:1", now_);
        sent_batches();
        ASSERT_FALSE(client_->receive(wire::Welcome{"a1", durable, {}, 1 << 20, server_understands_}, now_));
    }

    void add(int count) {
        for (int i = 0; i < count; ++i) client_->add(uniform_scan(laser_), now_);
    }

    /// Returns the number of scans of each batch that it sends now.
    std::vector<std::size_t> sent_batches() {
        std::vector<std::size_t> batches;
        while (const auto frame = client_->next_frame(now_)) {
            auto message = *wire::decode(std::string_view(*frame).substr(wire::kLengthPrefixBytes));
            if (const auto* compressed = std::get_if<wire::CompressedScanBatch>(&message)) {
                ++compressed_;
                message = wire::decompress(*compressed).value();
            }
            if (const auto* batch = std::get_if<wire::ScanBatch>(&message)) batches.push_back(batch->scans.size());
        }
        return batches;
    }

    ClientLink::Time now_{1000s};
    std::shared_ptr<const Sensor> laser_ = half_turn_laser();
    std::optional<ClientLink> client_;
    bool server_understands_ = true;
    int compressed_ = 0;
};

TEST_F(Batching, WithoutDelayEachScanIsSentAtOnce) {
    begin(0ms);
    for (int n = 0; n < 3; ++n) {
        add(1);
        EXPECT_THAT(sent_batches(), ElementsAre(1));
    }
}

TEST_F(Batching, BatchIsSentWhenItsOldestScanIsDue) {
    begin(1s);
    add(1);
    EXPECT_THAT(sent_batches(), IsEmpty());
    EXPECT_EQ(client_->protocol.deadline(now_), now_ + 1s);
    now_ += 600ms;
    add(1);
    EXPECT_THAT(sent_batches(), IsEmpty());
    EXPECT_EQ(client_->protocol.deadline(now_), now_ + 400ms);
    now_ += 399ms;
    EXPECT_THAT(sent_batches(), IsEmpty());
    now_ += 1ms;
    EXPECT_THAT(sent_batches(), ElementsAre(2));
    add(1);
    EXPECT_THAT(sent_batches(), IsEmpty()) << "the next scan has its own delay";
}

TEST_F(Batching, FullBatchDoesNotWait) {
    begin(1h);
    add(10); // of some 900 bytes each
    EXPECT_THAT(sent_batches(), ElementsAre(4, 4)) << "the last two wait for others";
}

TEST_F(Batching, LastScansDoNotWait) {
    begin(1h);
    add(2);
    client_->protocol.end();
    EXPECT_THAT(sent_batches(), ElementsAre(2));
}

TEST_F(Batching, ResentScansDoNotWaitAgain) {
    begin(1s);
    add(2);
    now_ += 1s;
    EXPECT_THAT(sent_batches(), ElementsAre(2));
    client_->protocol.close();
    connect(1);
    EXPECT_THAT(sent_batches(), ElementsAre(1));
}

TEST_F(Batching, ExpiredDelayWithoutCreditSetsNoDeadline) {
    begin(10ms);
    ASSERT_FALSE(client_->receive(wire::Ack{0, 0, 1}, now_));
    add(1);
    now_ += 10ms;
    EXPECT_THAT(sent_batches(), IsEmpty());
    EXPECT_GT(client_->protocol.deadline(now_), now_) << "only an ack gives new credit";
}

TEST_F(Batching, FullBatchesOnlySendsTheRestAtTheEnd) {
    auto options = client_options();
    options.batch_scans_max = 3;
    options.only_full_batches = true;
    client_.emplace(options, now_);
    connect();
    add(2);
    EXPECT_THAT(sent_batches(), IsEmpty());
    add(5);
    EXPECT_THAT(sent_batches(), ElementsAre(3, 3));
    client_->protocol.end();
    EXPECT_THAT(sent_batches(), ElementsAre(1));
}

TEST_F(Batching, ScansQueuedBeforeTheWelcomeFollowTheServersScans) {
    client_.emplace(client_options(), now_);
    add(3);
    EXPECT_TRUE(client_->buffer.drop_oldest_unsent());
    connect(40);
    EXPECT_THAT(sent_batches(), ElementsAre(2));
    EXPECT_EQ(client_->buffer.last(), 42U);
    ASSERT_FALSE(client_->receive(wire::Ack{42, 41, 1 << 20}, now_));
    EXPECT_EQ(client_->buffer.acknowledged(), 42U);
    EXPECT_EQ(client_->protocol.applied(), 41U);
    EXPECT_FALSE(client_->buffer.drop_oldest_unsent()) << "all were sent";
}

} // namespace
} // namespace scanloom::robot

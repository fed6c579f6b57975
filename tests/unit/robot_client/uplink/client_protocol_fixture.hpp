#pragma once

#include "tests/unit/robot_client/uplink/client_link.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {

/// A client and what it sends. The test is the server.
class ClientProtocolTest : public testing::Test {
protected:
    using Time = ClientLink::Time;
    static constexpr Time kStart{std::chrono::seconds{1000}};
    static constexpr std::uint64_t kPlenty = 1 << 20;

    void welcome(std::uint64_t last_durable = 0, std::uint64_t credit = kPlenty, wire::Limits limits = {}) {
        client_.protocol.open("host:1", now_);
        ASSERT_TRUE(std::holds_alternative<wire::Hello>(sent_messages().at(0)));
        ASSERT_FALSE(client_.receive(wire::Welcome{"a1", last_durable, limits, credit}, now_));
    }

    void add(int count) {
        for (int i = 0; i < count; ++i) client_.add(uniform_scan(laser_), now_);
    }

    std::optional<wire::LinkError> ack(std::uint64_t durable, std::uint64_t credit = kPlenty) {
        return client_.receive(wire::Ack{durable, durable, credit}, now_);
    }

    /// Returns the error of a link that begins with this welcome after the server acknowledged eight of ten scans.
    std::optional<wire::LinkError> welcomed_after_eight_acks(const wire::Welcome& again) {
        welcome();
        add(10);
        sent_messages();
        EXPECT_FALSE(ack(8));
        client_.protocol.close();
        client_.protocol.open("host:1", now_);
        sent_messages();
        return client_.receive(again, now_);
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
    std::shared_ptr<const Sensor> laser_ = half_turn_laser();
    ClientLink client_{client_options(), kStart};
    std::vector<std::size_t> frame_bytes_;
};

} // namespace scanloom::robot

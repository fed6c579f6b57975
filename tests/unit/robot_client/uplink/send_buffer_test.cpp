#include "robot_client/uplink/send_buffer.hpp"

#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace scanloom::robot {
namespace {

Observation observation(std::size_t beams = 10) {
    Observation made{std::make_shared<const Sensor>(), {}};
    made.scan.ranges.assign(beams, 1000);
    return made;
}

SendBuffer with_scans(int count) {
    SendBuffer buffer(1 << 20);
    for (int i = 0; i < count; ++i) buffer.push(observation());
    return buffer;
}

std::vector<Scan> unsent(const SendBuffer& buffer) {
    std::string frame;
    buffer.append_batch(buffer.sent() + 1, buffer.unsent_count(), frame);
    return std::get<wire::ScanBatch>(*wire::decode(std::string_view(frame).substr(wire::kLengthPrefixBytes))).scans;
}

TEST(SendBuffer, IsFullUntilScansAreAcknowledged) {
    SendBuffer buffer(3 * wire_bytes_max(observation().scan));
    int pushed = 0;
    for (; buffer.has_room(); ++pushed) buffer.push(observation());
    EXPECT_EQ(pushed, 3);
    buffer.mark_sent(2);
    EXPECT_FALSE(buffer.has_room()) << "sent scans are not stored yet";
    buffer.acknowledge(1);
    EXPECT_TRUE(buffer.has_room());
}

TEST(SendBuffer, RewindMayPassScansSentBeforeTheLastRewind) {
    SendBuffer buffer = with_scans(10);
    buffer.mark_sent(8);
    ASSERT_TRUE(buffer.rewind(2)); // this link breaks before any scan is sent again
    ASSERT_TRUE(buffer.rewind(7)) << "the first link had delivered 7";
    EXPECT_EQ(buffer.sent(), 7U);
    EXPECT_EQ(unsent(buffer).front().seq, 8U);
}

TEST(SendBuffer, RewindBeyondSentScansIsAConflict) {
    SendBuffer buffer = with_scans(10);
    buffer.mark_sent(8);
    EXPECT_THAT(buffer.rewind(9).error().message, testing::HasSubstr("another program"));
}

TEST(SendBuffer, DropsTheOldestUnsentScan) {
    SendBuffer buffer(1 << 20);
    for (std::size_t beams = 1; beams <= 6; ++beams) buffer.push(observation(beams));
    buffer.mark_sent(3);
    ASSERT_TRUE(buffer.rewind(1)); // two of them are to be sent again
    ASSERT_TRUE(buffer.drop_oldest_unsent());
    std::vector<std::size_t> beams;
    for (const Scan& scan : unsent(buffer)) {
        EXPECT_EQ(scan.seq, beams.size() + 2);
        EXPECT_EQ(scan.ranges.size(), buffer.beams(scan.seq));
        beams.push_back(scan.ranges.size());
    }
    EXPECT_THAT(beams, testing::ElementsAre(2, 3, 5, 6));
    buffer.mark_sent(4);
    EXPECT_FALSE(buffer.drop_oldest_unsent());
    buffer.acknowledge(5);
    EXPECT_TRUE(buffer.all_acknowledged());
    for (int n = 0; buffer.has_room() && n < 10'000; ++n) buffer.push(observation());
    EXPECT_GT(buffer.last(), 5000U) << "dropped scans take no space";
}

TEST(WireBytesMax, IsAtLeastTheEncodedSize) {
    for (const std::size_t beams : {1U, 180U, 4096U}) {
        for (int variant = 0; variant < 5; ++variant) {
            Scan scan;
            scan.seq = std::numeric_limits<std::uint64_t>::max();
            scan.stamp = 1e300;
            scan.sensor = 63;
            scan.pose = {1e6, -1e6, 1};
            scan.odometry = scan.pose;
            scan.ranges.assign(beams, kNoReturn);
            if (variant & 1) scan.intensities.assign(beams, std::numeric_limits<std::uint32_t>::max());
            if (variant & 2) scan.angles = ExplicitAngles(beams, 0.5);
            if (variant == 4) {
                SteppedAngles stepped{1e-12, std::vector<std::int32_t>(beams, 1 << 30)};
                for (std::size_t beam = 0; beam < beams; beam += 2) stepped.steps[beam] = -(1 << 30);
                scan.angles = std::move(stepped);
            }
            if (variant == 1) scan.angles = UniformAngles{0.5, 0.001, static_cast<std::uint32_t>(beams)};
            std::string frame;
            wire::encode(wire::ScanBatch{{scan}}, frame);
            EXPECT_LE(frame.size(), wire_bytes_max(scan) + 20);
        }
    }
}

} // namespace
} // namespace scanloom::robot

#include "robot_client/lidars/lidar_models.hpp"
#include "robot_client/lidars/ydlidar_packet.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/lidar_dialogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::LidarDialogue;
using testing_support::YdlidarEmulator;
using Bytes = std::vector<std::uint8_t>;

std::vector<YdlidarPacket> packets_in(const Bytes& bytes) {
    YdlidarDecoder decoder;
    decoder.feed(bytes);
    std::vector<YdlidarPacket> packets;
    while (auto packet = decoder.next()) packets.push_back(std::move(*packet));
    return packets;
}

TEST(YdlidarPacket, CorrectionsAreThoseOfTheManual) {
    EXPECT_NEAR(ydlidar_correction(1000.0), -6.7622, 1e-4);
    EXPECT_NEAR(ydlidar_correction(8000.0), -7.8374, 1e-4);
    EXPECT_NEAR(ydlidar_correction(155.3), 0.0, 1e-12);
    EXPECT_EQ(ydlidar_correction(0.0), 0.0);
}

TEST(YdlidarPacket, ReadsTheManualsPacket) {
    const auto packets = packets_in({0xAA, 0x55, 0x01, 0x01, 0x53, 0xAE, 0x53, 0xAE, 0xAB, 0x54, 0x00, 0x00});
    ASSERT_EQ(packets.size(), 1U);
    EXPECT_TRUE(packets[0].starts_turn);
    EXPECT_THAT(packets[0].beams, ElementsAre(LidarBeam{0xAE53 >> 1, {0, 0}}));
}

TEST(YdlidarPacket, AnglesAreSpreadAndCorrected) {
    // The manual's example: 40 samples from 223.78 to 243.47 degrees, the first at 1000 mm, the last at 8000 mm.
    std::vector<unsigned> words{0x55AA, 0x2800, 0x6FE5, 0x79BD, 0};
    for (int i = 0; i < 40; ++i) words.push_back(i == 0 ? 4000 : i == 39 ? 32'000 : 0);
    for (std::size_t i = 0; i < words.size(); ++i) words[4] ^= i == 4 ? 0U : words[i];
    Bytes bytes;
    for (const unsigned word : words) {
        bytes.push_back(static_cast<std::uint8_t>(word & 0xFFU));
        bytes.push_back(static_cast<std::uint8_t>(word >> 8));
    }
    const auto packets = packets_in(bytes);
    ASSERT_EQ(packets.size(), 1U);
    const auto& beams = packets[0].beams;
    ASSERT_EQ(beams.size(), 40U);
    EXPECT_FALSE(packets[0].starts_turn);
    EXPECT_NEAR(beams[0].step / 64.0, 217.0178, 0.02);
    EXPECT_NEAR(beams[39].step / 64.0, 235.6326, 0.02);
    EXPECT_NEAR(beams[20].step / 64.0, 223.78 + 19.69 * 20 / 39, 0.02) << "without a measurement, without a correction";
    EXPECT_EQ(beams[0].point.distance, 1000);
    EXPECT_EQ(beams[39].point.distance, 8000);
}

TEST(YdlidarPacket, DamagedPacketsAreDroppedAndTheNextIsFound) {
    YdlidarEmulator emulator(true);
    const auto good = emulator.next_turn();
    const auto expected = packets_in(good).size();
    EXPECT_EQ(expected, 10U);
    for (std::size_t at = 12; at < 12 + 90; ++at) {
        auto bytes = good;
        bytes[at] ^= 0x04U;
        EXPECT_EQ(packets_in(bytes).size(), expected - 1) << at;
        bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(at));
        EXPECT_EQ(packets_in(bytes).size(), expected - 1) << at;
    }
    Bytes twice{0xAA, 0xAA};
    twice.insert(twice.end(), good.begin() + 1, good.end());
    EXPECT_EQ(packets_in(twice).size(), expected) << "the mark begins at the second byte";
}

class YdlidarDrivers : public testing::Test {
protected:
    static std::unique_ptr<LidarDriver> driver(std::string_view model) {
        return make_lidar_driver(*find_lidar_model(model), scan_options(*find_lidar_model(model), {}).value());
    }
};

TEST_F(YdlidarDrivers, X4IsAskedAndStarted) {
    const auto x4 = driver("ydlidar-x4");
    YdlidarEmulator emulator(false);
    LidarDialogue dialogue(*x4, emulator);
    dialogue.open();
    EXPECT_FALSE(dialogue.failure());
    EXPECT_THAT(emulator.commands(), ElementsAre("65", "90", "92", "60"));
    EXPECT_THAT(dialogue.notes(), ElementsAre(HasSubstr("model 6, firmware 1.15, serial A0A1")));
    EXPECT_THAT(x4->stop_request(), ElementsAre(0xA5, 0x65));
    for (const double arrival : {1.0, 1.125, 1.25}) dialogue.turn(arrival);
    const auto taken = x4->next().value();
    EXPECT_EQ(taken.sensor->range_max, 10.0);
    EXPECT_THAT(taken.scan.intensities, IsEmpty());
    EXPECT_NEAR(taken.scan.duration, -0.125, 0.003) << "the first beam was taken last";
    EXPECT_NEAR(taken.scan.stamp, 1.0625, 1e-9);
}

TEST_F(YdlidarDrivers, X2IsOnlyRead) {
    const auto x2 = driver("ydlidar-x2");
    YdlidarEmulator emulator(true);
    LidarDialogue dialogue(*x2, emulator);
    dialogue.open();
    EXPECT_THAT(emulator.commands(), IsEmpty());
    EXPECT_THAT(x2->stop_request(), IsEmpty());
    dialogue.turn(1.0);
    dialogue.turn(1.1);
    const auto scan = x2->next().value().scan;
    ASSERT_EQ(scan.ranges.size(), 360U);
    const auto& angles = scan.angles.value();
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
        const double clockwise = 360.0 - beam_angle(angles, i) / kDegree;
        if (scan.ranges[i] == kInvalidRange) {
            EXPECT_NEAR(clockwise, 90.0, 0.01);
            continue;
        }
        const double raw = (scan.ranges[i] - 1000.0) / 10.0; // the sample's number
        EXPECT_NEAR(std::remainder(clockwise - raw - ydlidar_correction(scan.ranges[i]), 360.0), 0.0, 0.01) << i;
    }
}

TEST_F(YdlidarDrivers, ASilentX4Fails) {
    const auto x4 = driver("ydlidar-x4");
    YdlidarEmulator emulator(false, {.is_mute = true});
    LidarDialogue dialogue(*x4, emulator);
    dialogue.open();
    ASSERT_TRUE(dialogue.failure());
    EXPECT_THAT(dialogue.failure()->message, HasSubstr("no answer of a YDLIDAR X4 to a request"));
}

} // namespace
} // namespace scanloom::robot

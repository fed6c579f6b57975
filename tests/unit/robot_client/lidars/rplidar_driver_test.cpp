#include "robot_client/lidars/rplidar_driver.hpp"

#include "robot_client/lidars/lidar_models.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/lidar_dialogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::A5Emulation;
using testing_support::LidarDialogue;
using testing_support::RplidarEmulator;

/// A driver and an emulated sensor.
struct Pair {
    explicit Pair(A5Emulation emulation)
        : emulator(emulation), driver(make_lidar_driver(*find_lidar_model("rplidar-a1"),
                                                        scan_options(*find_lidar_model("rplidar-a1"), {}).value())) {}

    RplidarEmulator emulator;
    std::unique_ptr<LidarDriver> driver;
    LidarDialogue dialogue{*driver, emulator};
};

TEST(A5Protocol, RequestsHaveAChecksumIfTheyHaveData) {
    EXPECT_THAT(a5_request(0x20), ElementsAre(0xA5, 0x20));
    EXPECT_THAT(a5_request(0x82, {0, 0, 0, 0, 0}), ElementsAre(0xA5, 0x82, 5, 0, 0, 0, 0, 0, 0x22));
    EXPECT_THAT(a5_request(0xF0, {0x94, 0x02}), ElementsAre(0xA5, 0xF0, 2, 0x94, 0x02, 0xC1));
}

TEST(A5Protocol, DescriptorsAreFoundAmongOtherBytes) {
    const std::vector<std::uint8_t> bytes{0xA5, 0xA5, 0x5A, 0x05, 0, 0, 0x40, 0x81, 0x3E};
    EXPECT_EQ(find_a5_descriptor(bytes, {5, true, 0x81}), 8U);
    EXPECT_EQ(find_a5_descriptor(bytes, {5, false, 0x81}), std::nullopt);
    EXPECT_EQ(find_a5_descriptor(bytes, kA5Info), std::nullopt);
}

TEST(RplidarDriver, OldFirmwareSendsSinglePoints) {
    Pair pair({.firmware_minor = 15});
    pair.dialogue.open();
    EXPECT_FALSE(pair.dialogue.failure());
    EXPECT_THAT(pair.emulator.commands(), ElementsAre("25", "50", "52", "20"));
    EXPECT_THAT(pair.dialogue.notes(), ElementsAre("connected to an RPLIDAR A1: model 24, firmware 1.15, serial "
                                                   "A0A1A2A3A4A5A6A7A8A9AAABACADAEAF"));
    for (const double arrival : {10.0, 10.125, 10.25}) pair.dialogue.turn(arrival);
    const auto taken = pair.driver->next().value();
    EXPECT_EQ(taken.sensor->name, "RPLIDAR A1");
    ASSERT_EQ(taken.scan.ranges.size(), 360U);
    const auto& angles = taken.scan.angles.value();
    EXPECT_NEAR(beam_angle(angles, 0), 1.0 * kDegree, 1e-12) << "359 degrees clockwise";
    EXPECT_EQ(taken.scan.ranges[0], 1000U + 3590U);
    EXPECT_EQ(taken.scan.ranges[359], 1000U) << "ahead";
    EXPECT_EQ(taken.scan.ranges[359 - 90], kInvalidRange) << "no measurement";
    EXPECT_EQ(taken.scan.intensities[0], 47U);
    EXPECT_NEAR(taken.scan.duration, -0.125 * 359 / 360, 1e-9) << "the first beam was taken last";
    EXPECT_NEAR(taken.scan.stamp, 10.0625, 1e-9);
    EXPECT_TRUE(pair.driver->next());
    EXPECT_FALSE(pair.driver->next()) << "the last turn is not complete";
}

TEST(RplidarDriver, NewFirmwareSendsCapsules) {
    Pair pair({.firmware_minor = 29});
    pair.dialogue.open();
    EXPECT_THAT(pair.emulator.commands(), ElementsAre("25", "50", "52", "82"));
    for (const double arrival : {10.0, 10.125, 10.25, 10.375}) pair.dialogue.turn(arrival);
    const auto scan = pair.driver->next().value().scan;
    EXPECT_EQ(scan.ranges.size(), 384U);
    EXPECT_THAT(scan.intensities, IsEmpty()) << "capsules have none";
}

TEST(RplidarDriver, A2IsAskedToTurnItsMotor) {
    Pair pair({.model = 0x2C, .firmware_minor = 15});
    pair.dialogue.open();
    EXPECT_THAT(pair.emulator.commands(), ElementsAre("25", "50", "52", "F0", "20"));
    EXPECT_THAT(pair.driver->stop_request(), ElementsAre(0xA5, 0x25, 0xA5, 0xF0, 2, 0, 0, 0x57));
}

TEST(RplidarDriver, C1SendsSinglePoints) {
    Pair pair({.model = 0x41, .firmware_minor = 18});
    pair.dialogue.open();
    EXPECT_THAT(pair.emulator.commands(), ElementsAre("25", "50", "52", "20"));
}

TEST(RplidarDriver, ABrokenSensorIsReported) {
    Pair broken({.condition = 2});
    broken.dialogue.open();
    ASSERT_TRUE(broken.dialogue.failure());
    EXPECT_THAT(broken.dialogue.failure()->message,
                HasSubstr("an RPLIDAR A1 reports that it is broken (error 0x8002)"));
    EXPECT_FALSE(broken.emulator.is_measuring());
    Pair warning({.condition = 1});
    warning.dialogue.open();
    EXPECT_FALSE(warning.dialogue.failure());
    EXPECT_THAT(warning.dialogue.notes().back(), HasSubstr("reports a warning (0x8002)"));
    EXPECT_TRUE(warning.emulator.is_measuring());
}

TEST(RplidarDriver, ASilentSensorFailsAfterThreeRequests) {
    Pair pair({.is_mute = true});
    pair.dialogue.open();
    ASSERT_TRUE(pair.dialogue.failure());
    EXPECT_THAT(pair.dialogue.failure()->message, HasSubstr("no answer of an RPLIDAR A1 to a request"));
    EXPECT_THAT(pair.emulator.commands(), ElementsAre("25", "50", "50", "50"));
}

TEST(RplidarDriver, TheNoteAboutTheSensorIsNotRepeated) {
    Pair pair({});
    pair.dialogue.open();
    pair.dialogue.turn(1.0);
    pair.dialogue.open();
    EXPECT_EQ(pair.dialogue.notes().size(), 1U);
    EXPECT_FALSE(pair.driver->next()) << "turns do not go on after a break";
}

} // namespace
} // namespace scanloom::robot

#include "robot_client/lidars/hokuyo_driver.hpp"

#include "tests/support/angles.hpp"
#include "tests/support/lidar_dialogue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::HokuyoEmulator;
using testing_support::LidarDialogue;

class HokuyoDrivers : public testing::Test {
protected:
    static LidarScanOptions asked() { return {.range_min = 0.0, .range_max = 0.0, .mount = {0.1, 0.2, 0.3}}; }

    Observation observation(double arrival = 2000.0) {
        dialogue_.turn(arrival);
        auto taken = driver_.next();
        if (taken) return *taken;
        ADD_FAILURE() << "no scan";
        return {};
    }

    HokuyoDriver driver_{asked()};
    HokuyoEmulator emulator_;
    LidarDialogue dialogue_{driver_, emulator_};
};

TEST_F(HokuyoDrivers, AsksForTheParametersAndMeasures) {
    dialogue_.open();
    EXPECT_FALSE(dialogue_.failure());
    EXPECT_THAT(emulator_.commands(), ElementsAre("QT", "SCIP2.0", "VV", "PP", "MD0000108001000"));
    EXPECT_THAT(dialogue_.notes(),
                ElementsAre("Hokuyo UST-10LX, serial H1234567, firmware CE00486, 1081 beams, 40 scans per second"));
}

TEST_F(HokuyoDrivers, ScansHaveTheSensorsAnglesRangesAndTimes) {
    dialogue_.open();
    const auto [sensor, scan] = observation(2000.0);
    EXPECT_EQ(sensor->mount, (Pose2{0.1, 0.2, 0.3}));
    EXPECT_EQ(sensor->range_min, 0.02);
    EXPECT_EQ(sensor->range_max, 30.0);
    EXPECT_EQ(beam_count(sensor->angles), 1081U);
    EXPECT_NEAR(beam_angle(sensor->angles, 0), -135.0 * kDegree, 1e-12) << "on the right";
    EXPECT_NEAR(beam_angle(sensor->angles, 540), 0.0, 1e-12);
    EXPECT_NEAR(beam_angle(sensor->angles, 1080), 135.0 * kDegree, 1e-12);
    EXPECT_FALSE(scan.angles);
    ASSERT_EQ(scan.ranges.size(), 1081U);
    EXPECT_EQ(scan.ranges[0], 1000U);
    EXPECT_EQ(scan.ranges[1080], 2080U);
    EXPECT_EQ(scan.ranges[100], kInvalidRange) << "an error code";
    EXPECT_EQ(scan.ranges[200], kNoReturn);
    EXPECT_NEAR(scan.duration, 0.025 * 0.75, 1e-9) << "270 of 360 degrees, counter-clockwise";
    EXPECT_NEAR(scan.stamp, 2000.0 - scan.duration / 2.0, 1e-9) << "its last beam was taken before it was sent";
}

TEST_F(HokuyoDrivers, StampsFollowTheSensorsClockAcrossItsWrap) {
    dialogue_.open();
    const double first = observation(2000.0).scan.stamp;
    EXPECT_NEAR(observation(2000.035).scan.stamp, first + 0.025, 1e-9) << "it arrived late";
    EXPECT_NEAR(observation(2000.050).scan.stamp, first + 0.050, 1e-9);
}

TEST_F(HokuyoDrivers, TheUsersRangesReplaceThoseOfTheSensor) {
    HokuyoDriver near({.range_min = 1.1, .range_max = 1.2, .no_return = NoReturn::kDrop});
    LidarDialogue dialogue(near, emulator_);
    dialogue.open();
    dialogue.turn(1.0);
    const auto taken = near.next();
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->sensor->range_max, 1.2);
    EXPECT_EQ(taken->scan.ranges[99], kInvalidRange);
    EXPECT_EQ(taken->scan.ranges[150], 1150U);
    EXPECT_EQ(taken->scan.ranges[300], kInvalidRange);
    HokuyoDriver nothing({.range_min = 31.0, .range_max = 0.0});
    LidarDialogue other(nothing, emulator_);
    other.open();
    ASSERT_TRUE(other.failure());
    EXPECT_THAT(other.failure()->message, HasSubstr("from 31 to 30 m; no reading would be valid"));
}

TEST_F(HokuyoDrivers, ErrorCodesAreInvalidWhateverTheUsersRangeIs) {
    HokuyoDriver close({.range_min = 0.001, .range_max = 0.0});
    LidarDialogue dialogue(close, emulator_);
    dialogue.open();
    dialogue.turn(1.0);
    EXPECT_EQ(close.next()->scan.ranges[100], kInvalidRange) << "7 is an error code, not 7 mm";
}

TEST_F(HokuyoDrivers, AMedianSmoothesTheScan) {
    auto options = asked();
    options.median_window = 5;
    HokuyoDriver smooth(options);
    LidarDialogue dialogue(smooth, emulator_);
    dialogue.open();
    dialogue.turn(1.0);
    EXPECT_EQ(smooth.next()->scan.ranges[500], 1500U);
}

TEST_F(HokuyoDrivers, DamagedScansAreDroppedAndCounted) {
    dialogue_.open();
    auto bytes = emulator_.next_turn();
    bytes[500] ^= 1U;
    dialogue_.send(bytes, 2000.0);
    EXPECT_FALSE(driver_.next());
    EXPECT_EQ(observation().scan.ranges.size(), 1081U);
    EXPECT_EQ(driver_.counts().damaged, 1U);
    EXPECT_EQ(driver_.counts().turns, 1U);
}

TEST_F(HokuyoDrivers, AnAbnormalStatusIsReportedOnce) {
    dialogue_.open();
    const std::string status = std::string("MD0000108001000\n21") + scip_sum("21") + "\n\n";
    for (int i = 0; i < 2; ++i) dialogue_.send({status.begin(), status.end()}, 2000.0);
    EXPECT_THAT(dialogue_.notes().back(), HasSubstr("abnormal status: 21"));
    EXPECT_EQ(dialogue_.notes().size(), 2U);
    EXPECT_EQ(observation().scan.ranges.size(), 1081U);
}

TEST_F(HokuyoDrivers, ARefusedMeasurementFails) {
    HokuyoDriver driver(asked());
    (void)driver.on_open();
    const auto answer = [&](const std::string& text) {
        return driver.on_bytes(std::vector<std::uint8_t>(text.begin(), text.end()), 1.0);
    };
    (void)answer("QT\n00P\n\nSCIP2.0\n00P\n\nVV\n00P\n\n");
    std::string parameters = "PP\n00P\n";
    for (const std::string setting :
         {"MODL:U", "DMIN:20", "DMAX:5600", "ARES:1024", "AMIN:44", "AMAX:725", "AFRT:384", "SCAN:600"}) {
        parameters += setting + ";" + scip_sum(setting) + "\n";
    }
    const auto started = answer(parameters + "\n");
    EXPECT_EQ(std::string(started.send.begin(), started.send.end()), "MD0044072501000\n");
    const auto refused = answer(std::string("MD0044072501000\n10") + scip_sum("10") + "\n\n");
    ASSERT_TRUE(refused.failure);
    EXPECT_THAT(refused.failure->message, HasSubstr("refuses to measure (status 10)"));
}

TEST_F(HokuyoDrivers, ASilentDeviceFails) {
    testing_support::RplidarEmulator other({.is_mute = true});
    LidarDialogue dialogue(driver_, other);
    dialogue.open();
    ASSERT_TRUE(dialogue.failure());
    EXPECT_THAT(dialogue.failure()->message, HasSubstr("no answer of a Hokuyo to QT"));
}

TEST_F(HokuyoDrivers, AnEarlierMeasurementIsStopped) {
    dialogue_.open();
    const auto earlier = emulator_.next_turn();
    (void)driver_.on_open();
    EXPECT_FALSE(driver_.on_bytes(earlier, 1.0).failure) << "bytes of the earlier measurement";
    EXPECT_FALSE(driver_.next());
    const auto stop = driver_.stop_request();
    EXPECT_EQ(std::string(stop.begin(), stop.end()), "QT\n");
}

} // namespace
} // namespace scanloom::robot

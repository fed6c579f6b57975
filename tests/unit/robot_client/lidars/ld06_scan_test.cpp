#include "robot_client/lidars/ld06_turns.hpp"

#include "common/wire/frame_decoder.hpp"
#include "common/wire/messages.hpp"
#include "tests/support/angles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;

LidarTurn turn_of(std::vector<LidarBeam> beams) { return {12.5, std::move(beams)}; }

TEST(Ld06Scan, AnglesAreCounterClockwise) {
    const auto scan = ld06_scan(turn_of({{0, {1000, 201}},
                                         {90 * kLd06StepsPerDegree, {2000, 202}}, // to the right
                                         {350 * kLd06StepsPerDegree + 1, {3000, 203}}}),
                                {});
    EXPECT_EQ(scan.stamp, 12.5);
    EXPECT_THAT(scan.ranges, ElementsAre(3000, 2000, 1000));
    EXPECT_THAT(scan.intensities, ElementsAre(203, 202, 201));
    const auto& angles = scan.angles.value();
    EXPECT_THAT(std::get<SteppedAngles>(angles).steps, ElementsAre(10 * kLd06StepsPerDegree - 1, 270 * 1100, 396'000));
    EXPECT_NEAR(beam_angle(angles, 0), (10.0 - 0.01 / 11.0) * kDegree, 1e-15) << "slightly to the left";
    EXPECT_NEAR(beam_angle(angles, 1), 270.0 * kDegree, 1e-15);
    EXPECT_NEAR(beam_angle(angles, 2), 360.0 * kDegree, 1e-15) << "ahead";
}

TEST(Ld06Scan, TheFirstBeamWasTakenLast) {
    LidarTurn turn = turn_of({{0, {1000, 201}}, {100, {2000, 202}}});
    turn.duration = 0.0998;
    EXPECT_EQ(ld06_scan(turn, {}).duration, -0.0998);
    turn.duration = 11.0;
    EXPECT_EQ(ld06_scan(turn, {}).duration, 0.0) << "more than a scan may have";
}

TEST(Ld06Scan, UnmeasuredPointsAreInvalidAndDistantOnesAreNoReturns) {
    const auto turn = turn_of({{0, {0, 212}},
                               {1, {19, 200}},
                               {2, {20, 200}},
                               {3, {5000, 99}},
                               {4, {5000, 100}},
                               {5, {11'999, 200}},
                               {6, {12'000, 200}},
                               {7, {12'000, 99}}});
    EXPECT_THAT(ld06_scan(turn, {}).ranges,
                ElementsAre(kInvalidRange, kNoReturn, 11'999, 5000, kInvalidRange, 20, kInvalidRange, kInvalidRange));
    EXPECT_THAT(ld06_scan(turn, {.range_min = 0.0, .range_max = 5.0, .confidence_min = 0}).ranges,
                ElementsAre(kNoReturn, kNoReturn, kNoReturn, kNoReturn, kNoReturn, 20, 19, kInvalidRange));
    EXPECT_EQ(ld06_scan(turn, {.no_return = NoReturn::kDrop}).ranges[1], kInvalidRange);
    EXPECT_EQ(ld06_scan(turn, {.confidence_min = 255}).ranges, std::vector<RangeMm>(8, kInvalidRange));
}

TEST(Ld06Scan, IsFilteredOnlyOnRequest) {
    std::vector<LidarBeam> beams;
    for (std::int32_t i = 0; i < 450; ++i) beams.push_back({i * 880, {1000, 200}});
    beams[0].point.distance = 9000;
    beams[200].point.distance = 9000;
    beams[300].point.distance = 0;
    EXPECT_EQ(ld06_scan(turn_of(beams), {}).ranges[249], 9000U);
    auto smooth = ld06_scan(turn_of(beams), {.median_window = 5}).ranges;
    EXPECT_EQ(std::exchange(smooth[149], 1000), kInvalidRange);
    EXPECT_THAT(smooth, testing::Each(1000U));
}

TEST(Ld06Scan, ScanAndSensorPassServerValidation) {
    const LidarScanOptions options{.range_min = 0.1, .range_max = 8.0, .mount = {0.1, -0.2, 3.0}};
    const Sensor sensor = *ld06_sensor(options);
    EXPECT_EQ(sensor.mount, options.mount);
    EXPECT_EQ(sensor.range_min, 0.1);
    EXPECT_EQ(sensor.range_max, 8.0);
    Scan scan = ld06_scan(turn_of({{5, {100, 255}}, {395'999, {200, 0}}}), options);
    scan.seq = 1;
    for (const wire::Message& message : {wire::Message(sensor), wire::Message(wire::ScanBatch{{scan}})}) {
        std::string frame;
        wire::encode(message, frame);
        EXPECT_EQ(wire::decode(std::string_view(frame).substr(wire::kLengthPrefixBytes)).value(), message);
    }
    EXPECT_TRUE(wire::check_scan(scan, sensor));
}

} // namespace
} // namespace scanloom::robot

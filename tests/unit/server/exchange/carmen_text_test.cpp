#include "server/exchange/carmen_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::exchange {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Sensor laser() {
    Sensor sensor;
    sensor.angles = UniformAngles{-0.5, 0.25, 4};
    sensor.mount = {0.25, 0.0, 0.0};
    sensor.range_min = 0.1;
    sensor.range_max = 12.0;
    return sensor;
}

Scan scan() {
    Scan taken;
    taken.seq = 1;
    taken.stamp = 976052857.125;
    taken.pose = {1.0, 2.0, 0.0};
    taken.ranges = {2005, kInvalidRange, kNoReturn, 99};
    return taken;
}

/// Feeds what comes before a scan.
CarmenText after(const Sensor& sensor) {
    CarmenText carmen;
    EXPECT_EQ(carmen.lines(RobotJoined{0, "crawler"}).value(), "");
    EXPECT_TRUE(carmen.lines(SensorDescribed{0, sensor}));
    return carmen;
}

TEST(CarmenText, WritesAScanAsOneLine) {
    auto carmen = after(laser());
    EXPECT_EQ(carmen.lines(ScanTaken{0, scan()}).value(),
              "ROBOTLASER1 0 -0.5 0.75 0.25 12 0 0 4 2.005 0 12 0 0 1.25 2 0 1.25 2 0 0 0 0 0 0 976052857.125 crawler "
              "976052857.125\n");
}

TEST(CarmenText, OmitsScansThatAreNotIntegrated) {
    CarmenText carmen{ScanFilter(2.0)};
    EXPECT_EQ(carmen.lines(RobotJoined{0, "crawler"}).value(), "");
    EXPECT_TRUE(carmen.lines(SensorDescribed{0, laser()}));
    EXPECT_THAT(carmen.lines(ScanTaken{0, scan()}).value(), StartsWith("ROBOTLASER1"));
    Scan stray = scan();
    stray.pose->x += 2.5;
    EXPECT_EQ(carmen.lines(ScanTaken{0, stray}).value(), "");
    EXPECT_THAT(carmen.lines(ScanTaken{0, scan()}).value(), StartsWith("ROBOTLASER1"));
}

TEST(CarmenText, NumbersSurviveReading) {
    auto carmen = after(laser());
    Scan taken = scan();
    taken.pose = {1.0 / 3.0, -1e-17, 2.0 / 7.0};
    taken.angles = UniformAngles{-1.0 / 3.0, 1.0 / 7.0, 4};
    const auto line = carmen.lines(ScanTaken{0, taken}).value();
    EXPECT_THAT(line, HasSubstr(" -0.3333333333333333 "));
    EXPECT_THAT(line, HasSubstr(" 0.14285714285714285 12 "));
    EXPECT_THAT(line, HasSubstr(" 0.2857142857142857 "));
}

TEST(CarmenText, KeepsTheOrderOfScansOfAnotherClock) {
    auto carmen = after(laser());
    const auto stamp_of = [&](double stamp) {
        Scan taken = scan();
        taken.stamp = stamp;
        return carmen.lines(ScanTaken{0, taken}).value();
    };
    EXPECT_THAT(stamp_of(1000.0), HasSubstr(" 1000 crawler 1000\n"));
    EXPECT_THAT(stamp_of(998.5), HasSubstr(" 998.5 crawler 998.5\n")) << "as stamps jitter";
    const auto by_another_clock = stamp_of(7.25);
    EXPECT_THAT(by_another_clock, testing::StartsWith("# the next line's own stamp is 7.25"));
    EXPECT_THAT(by_another_clock, HasSubstr(" 1000 crawler 1000\n"));
    EXPECT_THAT(stamp_of(1000.1), testing::StartsWith("ROBOTLASER1"));
}

TEST(CarmenText, AddsACommentForALongRangeSensor) {
    CarmenText carmen;
    Sensor far = laser();
    far.range_max = 80.0;
    ASSERT_TRUE(carmen.lines(RobotJoined{0, "crawler"}));
    EXPECT_THAT(carmen.lines(SensorDescribed{0, far}).value(), HasSubstr("replay with --max-range 1000"));
    EXPECT_EQ(carmen.lines(SensorDescribed{0, laser()}).value(), "");
}

TEST(CarmenText, RejectsSensorsThatTheFormatCannotRepresent) {
    Sensor uneven = laser();
    uneven.angles = ExplicitAngles{-0.5, 0.0, 0.1, 0.9};
    Sensor wide = laser();
    wide.aperture = 0.1;
    Sensor sonar = laser();
    sonar.kind = SensorKind::kSonar;
    for (const auto& [sensor, why] : {std::pair{uneven, "evenly"}, {wide, "aperture"}, {sonar, "sonars"}}) {
        const auto refused = after(sensor).lines(ScanTaken{0, scan()});
        ASSERT_FALSE(refused) << why;
        EXPECT_EQ(refused.error().code, Errc::kConflict);
        EXPECT_THAT(refused.error().message, testing::AllOf(HasSubstr(why), HasSubstr("sensor 0 of robot 'crawler'")));
    }
    Scan unknown = scan();
    unknown.sensor = 7;
    EXPECT_EQ(after(laser()).lines(ScanTaken{0, unknown}).error().code, Errc::kMalformed);
}

} // namespace
} // namespace scanloom::exchange

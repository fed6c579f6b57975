#include "robot_client/ros/laser_conversion.hpp"

#include "common/scan/limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace scanloom::robot {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

RosLaserScan scan_with(std::vector<float> ranges) {
    return {{5'000'000'000, "laser"}, -1.0F, 1.0F, 0.01F, 0.001F, 0.1F, 0.2F, 10.0F, std::move(ranges)};
}

RangeMeaning meaning_of(const RosLaserScan& scan, const RangeOptions& options = {}) {
    RangeHabits habits;
    habits.add(scan);
    return habits.meaning(options);
}

std::vector<RangeMm> ranges_of(const RosLaserScan& scan, const RangeOptions& options = {}) {
    return scan_of(scan, 0, meaning_of(scan, options)).ranges;
}

TEST(LaserConversion, ReadingsFollowRep117) {
    const auto scan = scan_with({1.2345F, INFINITY, -INFINITY, kNan, 0.0F, -1.0F, 10.0F, 11.0F});
    EXPECT_EQ(ranges_of(scan), (std::vector<RangeMm>{1235, kNoReturn, kInvalidRange, kInvalidRange, kInvalidRange,
                                                     kInvalidRange, kNoReturn, kInvalidRange}));
}

TEST(LaserConversion, OneNumberAboveTheRangeIsNoReturnIfNoneIsInfinite) {
    EXPECT_EQ(ranges_of(scan_with({1.0F, 81.91F, 81.91F})), (std::vector<RangeMm>{1000, kNoReturn, kNoReturn}));
    EXPECT_EQ(ranges_of(scan_with({1.0F, 81.91F, 12.0F})), (std::vector<RangeMm>{1000, kInvalidRange, kInvalidRange}));
    EXPECT_EQ(ranges_of(scan_with({1.0F, 81.91F, INFINITY})), (std::vector<RangeMm>{1000, kInvalidRange, kNoReturn}));
}

TEST(LaserConversion, OptionsDecideBeforeHabits) {
    const auto scan = scan_with({0.0F, 81.91F, INFINITY, 6.0F});
    RangeOptions options{.is_zero_no_return = true, .is_beyond_no_return = true};
    EXPECT_EQ(ranges_of(scan, options), (std::vector<RangeMm>{kNoReturn, kNoReturn, kNoReturn, 6000}));
    options.no_return = NoReturn::kDrop;
    options.range_max = 5.0;
    EXPECT_EQ(ranges_of(scan, options), (std::vector<RangeMm>(4, kInvalidRange))) << "6 m are beyond --max-range";
    EXPECT_EQ(sensor_of(scan, meaning_of(scan, options), {}).range_max, 5.0);
}

TEST(LaserConversion, SensorsHaveTheRangesOfTheirMessagesIfThesePossible) {
    auto scan = scan_with({1.0F, 2.0F});
    EXPECT_EQ(sensor_of(scan, {}, {}).range_max, 10.0);
    EXPECT_EQ(sensor_of(scan, {}, {}).range_min, static_cast<double>(0.2F));
    for (const float stated : {kNan, 0.0F, -5.0F, INFINITY, 1e9F}) {
        scan.range_max = stated;
        EXPECT_EQ(sensor_of(scan, {}, {}).range_max, kBelievedRangeMax) << stated;
    }
    for (const float stated : {kNan, -1.0F, 60.0F}) {
        scan.range_min = stated;
        EXPECT_EQ(sensor_of(scan, {}, {}).range_min, 0.0) << stated;
    }
}

/// Drivers of sensors with one beam state an increment of 0, which the server refuses.
TEST(LaserConversion, OneBeamNeedsNoIncrement) {
    auto scan = scan_with({1.0F});
    for (const float stated : {0.0F, -3e38F}) {
        scan.angle_increment = stated;
        ASSERT_TRUE(check_usable(scan));
        const auto angles = std::get<UniformAngles>(sensor_of(scan, {}, {}).angles);
        EXPECT_EQ(angles.count, 1U);
        EXPECT_EQ(angles.first, -1.0);
        EXPECT_GT(angles.increment, 0.0);
        EXPECT_LT(angles.increment, 1.0);
    }
}

TEST(LaserConversion, TheStampIsThatOfTheMiddle) {
    auto scan = scan_with(std::vector<float>(101, 1.0F));
    EXPECT_NEAR(scan_of(scan, 0, {}).stamp, 5.05, 1e-6);
    EXPECT_NEAR(scan_of(scan, 0, {}).duration, 0.1, 1e-6);
    EXPECT_EQ(middle_of(scan, 0), 5'050'000'002) << "of a float32";
    scan.header.stamp = 0;
    EXPECT_NEAR(scan_of(scan, 7'000'000'000, {}).stamp, 7.05, 1e-6) << "no stamp: when it was recorded";
    for (const float increment : {kNan, INFINITY, 1.0F}) { // 1 s from beam to beam is too long
        scan.time_increment = increment;
        EXPECT_EQ(duration_of(scan), 0.0) << increment;
    }
}

TEST(LaserConversion, AnglesOfAnUpsideDownLaserAreNegated) {
    const Eigen::Isometry3d T_robot_laser = Eigen::Translation3d(0.3, 0.1, 0.5) *
                                            Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
                                            Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
    const auto mount = mount_of(T_robot_laser).value();
    EXPECT_TRUE(mount.is_upside_down);
    const auto scan = scan_with({1.0F, 2.0F});
    const Sensor sensor = sensor_of(scan, {}, mount);
    for (const std::size_t beam : {0U, 1U}) {
        const double angle = -1.0 + 0.01 * static_cast<double>(beam);
        const Eigen::Vector3d hit = T_robot_laser * Eigen::Vector3d(2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.0);
        const double direction = beam_angle(sensor.angles, beam);
        const Point2 shown = transform(sensor.mount, Point2{2.0 * std::cos(direction), 2.0 * std::sin(direction)});
        EXPECT_NEAR(shown.x, hit.x(), 1e-6);
        EXPECT_NEAR(shown.y, hit.y(), 1e-6);
    }
}

TEST(LaserConversion, TiltedOrDistantLasersAreRefused) {
    const auto tilted = [](double degrees) {
        return mount_of(
            Eigen::Isometry3d(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitY())));
    };
    EXPECT_FALSE(tilted(14.0).value().is_upside_down);
    EXPECT_TRUE(tilted(170.0).value().is_upside_down);
    EXPECT_EQ(tilted(90.0).error().message, "the laser is tilted by more than 15 degrees");
    EXPECT_FALSE(mount_of(Eigen::Isometry3d(Eigen::Translation3d(2e6, 0.0, 0.0))));
}

TEST(LaserConversion, ScansThatCannotBeUsedSayWhy) {
    const auto reason = [](const RosLaserScan& scan) { return check_usable(scan).error().message; };
    EXPECT_EQ(reason(scan_with({})), "no beams");
    EXPECT_EQ(reason(scan_with(std::vector<float>(kBeamsMax + 1, 1.0F))), "more than 4096 beams");
    auto scan = scan_with({1.0F, 1.0F, 1.0F});
    scan.angle_increment = 0.0F;
    EXPECT_EQ(reason(scan), "an angle increment of 0");
    scan.angle_increment = kNan;
    EXPECT_EQ(reason(scan), "angles that are not finite");
    scan.angle_increment = 57.3F; // degrees
    EXPECT_EQ(reason(scan), "beams that span more than a full turn");
    auto turn = scan_with(std::vector<float>(360, 1.0F));
    turn.angle_increment = 0.017501922F; // a TurtleBot3: 4.8e-6 rad more than a turn
    EXPECT_TRUE(check_usable(turn));
}

} // namespace
} // namespace scanloom::robot

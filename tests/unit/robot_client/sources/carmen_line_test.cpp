#include "robot_client/sources/carmen_line.hpp"

#include "tests/support/angles.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

CarmenScan scan_of(std::string_view line) {
    auto parsed = parse_carmen_line(line);
    EXPECT_TRUE(parsed) << line << ": " << (parsed ? "" : parsed.error().message);
    if (!parsed || !std::holds_alternative<CarmenScan>(*parsed)) {
        ADD_FAILURE() << "not a scan: " << line;
        return {};
    }
    return std::get<CarmenScan>(*parsed);
}

std::string error_of(std::string_view line) {
    auto parsed = parse_carmen_line(line);
    return parsed ? "no error" : parsed.error().message;
}

std::string flaser_with(std::size_t beams) {
    std::string line = fmt::format("FLASER {}", beams);
    for (std::size_t i = 0; i < beams; ++i) line += " 1.5";
    return line + " 1 2 0.3 4 5 0.6 13.5 host 13.6";
}

TEST(CarmenLine, FlaserContainsLaserPoseThenOdometry) {
    const auto scan = scan_of("FLASER 3 1.0 2.5 81.83 1 2 0.3 4 5 0.6 13.5 host 0.25");
    EXPECT_EQ(scan.kind, CarmenKind::kFlaser);
    EXPECT_EQ(scan.ranges, (std::vector<RangeMm>{1000, 2500, 81'830}));
    EXPECT_EQ(scan.laser, (Pose2{1, 2, 0.3}));
    EXPECT_EQ(scan.robot, (Pose2{4, 5, 0.6}));
    EXPECT_EQ(scan.stamp, 13.5);
    EXPECT_FALSE(scan.range_max);
}

TEST(CarmenLine, FlaserTrailerMayOmitStamps) {
    EXPECT_EQ(scan_of("FLASER 1 1.0 1 2 0.3 4 5 0.6 host 7.5").stamp, 7.5);
    EXPECT_EQ(scan_of("FLASER 1 1.0 1 2 0.3 4 5 0.6").stamp, std::nullopt);
}

TEST(CarmenLine, FlaserAnglesFollowFromTheBeamCount) {
    const auto angles = [](std::size_t beams) { return scan_of(flaser_with(beams)).angles; };
    EXPECT_EQ(angles(180), (UniformAngles{-90.0 * kDegree, kDegree, 180}));
    EXPECT_EQ(angles(181), (UniformAngles{-90.0 * kDegree, kDegree, 181}));
    EXPECT_EQ(angles(360).increment, std::numbers::pi / 360.0);
    EXPECT_EQ(angles(361).increment, std::numbers::pi / 360.0);
    EXPECT_NEAR(angles(180).first + 179 * angles(180).increment, 89.0 * kDegree, 1e-12)
        << "the angles must not be stretched to +90 degrees";
    EXPECT_NEAR(angles(682).first + 681 * angles(682).increment, 90.0 * kDegree, 1e-12);
    EXPECT_EQ(angles(1).first, 0.0);
}

constexpr std::string_view kRobotLaserHead = "ROBOTLASER1 0 -1.5708 3.1416 0.0175 50.0 0.01 0 3 1.0 60.0 2.0 ";
constexpr std::string_view kPoses = "1.0 2.0 0.3 1.1 2.1 0.31 0 0 0 0 ";

TEST(CarmenLine, RobotLaserIsReadInEachForm) {
    for (const std::string_view remissions : {"", "0 ", "3 7 8 9 "}) {
        for (const std::string_view trailer : {"13.0 host 13.1", ""}) {
            for (const std::string_view turn_axis : {"0.25 ", ""}) {
                if (!remissions.empty() && turn_axis.empty()) continue; // files with remissions have a turn_axis
                const auto line = fmt::format("{}{}{}{}{}", kRobotLaserHead, remissions, kPoses, turn_axis, trailer);
                const auto scan = scan_of(line);
                EXPECT_EQ(scan.laser, (Pose2{1.0, 2.0, 0.3})) << line;
                EXPECT_EQ(scan.robot, (Pose2{1.1, 2.1, 0.31})) << line;
                EXPECT_EQ(scan.stamp, trailer.empty() ? std::nullopt : std::optional(13.0)) << line;
            }
        }
    }
}

TEST(CarmenLine, RobotLaserUsesTheLoggersStampIfItIsTheOnlyOne) {
    EXPECT_EQ(scan_of(fmt::format("{}0 {}0 host 13.1", kRobotLaserHead, kPoses)).stamp, 13.1);
}

TEST(CarmenLine, RobotLaserContainsAnglesAndRange) {
    const auto scan = scan_of(fmt::format("{}0 {}0 13.0 host 13.1", kRobotLaserHead, kPoses));
    EXPECT_EQ(scan.angles, (UniformAngles{-1.5708, 0.0175, 3}));
    EXPECT_EQ(scan.range_max, 50.0);
    EXPECT_EQ(scan.sensor, 0U);
}

TEST(CarmenLine, FullTurnWithFloat32IncrementIsRead) {
    std::string line = "ROBOTLASER1 0 0.0 6.2831853 0.017501922 3.5 0.01 0 360 ";
    for (int beam = 0; beam < 360; ++beam) line += "1.0 ";
    EXPECT_EQ(scan_of(fmt::format("{}0 {}0 13.0 host 13.1", line, kPoses)).ranges.size(), 360U);
}

TEST(CarmenLine, RawLaserIsReadWithoutPoses) {
    for (const std::string_view tail : {"0 13.0 host 13.1", "2 5 6 13.0 host 13.1", "13.0 host 13.1", "0"}) {
        const auto line = fmt::format("RAWLASER1 0 -1.5708 3.1416 0.0175 81.9 0.01 0 2 1.0 2.0 {}", tail);
        EXPECT_EQ(scan_of(line).kind, CarmenKind::kRawLaser) << line;
        EXPECT_EQ(scan_of(line).ranges.size(), 2U) << line;
    }
}

TEST(CarmenLine, ReadingsAreMillimetresNoReturnOrInvalid) {
    const auto scan = scan_of("FLASER 6 nan inf -inf -1 1e999 5e6 1 2 0.3 4 5 0.6 13.5 host 0.25");
    EXPECT_EQ(scan.ranges, (std::vector<RangeMm>{0, kNoReturn, 0, 0, kNoReturn, kNoReturn}));
}

TEST(CarmenLine, OtherLinesAreIgnored) {
    for (const std::string_view line : {"", "   ", "# FLASER 1", "NEFF 15", "SYNC x", "IMU 1 2",
                                        "PARAM robot_width 1 h 2", "ODOM broken", "\xff\xfe\x01"}) {
        auto parsed = parse_carmen_line(line);
        ASSERT_TRUE(parsed) << line;
        EXPECT_TRUE(std::holds_alternative<std::monostate>(*parsed)) << line;
    }
}

TEST(CarmenLine, OdometryAndLaserOffsetAreRead) {
    const auto odometry = parse_carmen_line("ODOM 1 2 0.5 0 0 0 7.25 host 7.5");
    EXPECT_EQ(std::get<CarmenOdometry>(*odometry).robot, (Pose2{1, 2, 0.5}));
    EXPECT_EQ(std::get<CarmenOdometry>(*odometry).stamp, 7.25);
    const auto offset = parse_carmen_line("PARAM robot_frontlaser_offset -0.04 10.5 host 10.5");
    EXPECT_EQ(std::get<CarmenLaserOffset>(*offset).forward, -0.04);
}

TEST(CarmenLine, InvalidLineIsRefusedWithTheReason) {
    EXPECT_THAT(error_of("FLASER"), HasSubstr("FLASER: the number of beams"));
    EXPECT_THAT(error_of("FLASER x 1 2"), HasSubstr("number of beams"));
    EXPECT_THAT(error_of("FLASER -3 1 2"), HasSubstr("number of beams"));
    EXPECT_THAT(error_of("FLASER 0 1 2 0.3 4 5 0.6"), HasSubstr("0 beams"));
    EXPECT_THAT(error_of("FLASER 100000 1 2"), HasSubstr("100000 beams, at most 4096"));
    EXPECT_THAT(error_of("FLASER 5 1 2 3"), HasSubstr("5 beams are announced, but 3 values follow"));
    EXPECT_THAT(error_of("FLASER 2 1 abc 1 2 0.3 4 5 0.6"), HasSubstr("range 2 is 'abc'"));
    EXPECT_THAT(error_of("FLASER 2 1 2 3 1 2 0.3 4 5 0.6"), HasSubstr("7 values follow the 2 ranges"));
    EXPECT_THAT(error_of("FLASER 1 1 nan 2 0.3 4 5 0.6"), HasSubstr("laser_x is nan"));
    EXPECT_THAT(error_of("FLASER 1 1 1 2 0.3 4 inf 0.6"), HasSubstr("odom_y is inf"));
    EXPECT_THAT(error_of("FLASER 1 1 1e7 2 0.3 4 5 0.6"), HasSubstr("the limit is 1000000"));
    EXPECT_THAT(error_of("FLASER 1 1 1 2 0.3 4 5 0.6 x host 1"), HasSubstr("timestamp is 'x'"));
    EXPECT_THAT(error_of("ROBOTLASER1 0 1"), HasSubstr("ends within the laser's parameters"));
    EXPECT_THAT(error_of("ROBOTLASER1 0 -1.5 3 0 50 0.01 0 1 1.0 0 1 2 3 1 2 3 0 0 0 0 0"),
                HasSubstr("angular_resolution is 0"));
    EXPECT_THAT(error_of("ROBOTLASER1 0 0 3 4 50 0.01 0 3 1 1 1 0 1 2 3 1 2 3 0 0 0 0 0"),
                HasSubstr("more than a full turn"));
    EXPECT_THAT(error_of(fmt::format("{}0 1 2 3", kRobotLaserHead)), HasSubstr("fit no form"));
}

TEST(CarmenLine, MessagesOmitControlCharactersAndLongTokens) {
    const auto message = error_of("FLASER 1 \x1b[2J" + std::string(5000, 'x') + " 1 2 0.3 4 5 0.6");
    EXPECT_LT(message.size(), 100U);
    EXPECT_EQ(message.find('\x1b'), std::string::npos);
}

TEST(CarmenLine, TruncatedLinesDoNotCrash) {
    const std::string line = fmt::format("{}2 7 8 {}0 13.0 host 13.1", kRobotLaserHead, kPoses);
    for (std::size_t length = 0; length <= line.size(); ++length) {
        const auto parsed = parse_carmen_line(std::string_view(line).substr(0, length));
        if (parsed) continue;
        EXPECT_FALSE(parsed.error().message.empty());
    }
}

} // namespace
} // namespace scanloom::robot

#include "robot_client/sources/carmen_log.hpp"

#include "tests/support/packed_text.hpp"
#include "tests/support/whole_log.hpp"
#include "tests/unit/robot_client/sources/carmen_log_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing_support::bzip2;
using testing_support::gzip;

TEST_F(CarmenLogFile, ReadsPlainAndCompressedFiles) {
    std::string text = "# comment\r\n";
    for (int i = 0; i < 3000; ++i) text += flaser(i);
    const auto plain = read(text);
    ASSERT_TRUE(plain);
    EXPECT_EQ(plain->observations.size(), 3000U);
    for (const std::string& bytes :
         {gzip(text), bzip2(text), text_of({gzip(text.substr(0, 999)), gzip(text.substr(999))}),
          text_of({bzip2(text.substr(0, 999)), bzip2(text.substr(999))})}) {
        const auto log = read(bytes);
        ASSERT_TRUE(log) << log.error().message;
        ASSERT_EQ(log->observations.size(), 3000U);
        for (std::size_t i = 0; i < 3000; ++i) EXPECT_EQ(log->observations[i].scan, plain->observations[i].scan);
    }
}

TEST_F(CarmenLogFile, ReadsALastLineWithoutLineBreak) {
    auto text = text_of({flaser(1), flaser(2)});
    text.pop_back();
    EXPECT_EQ(read(text)->observations.size(), 2U);
}

TEST_F(CarmenLogFile, MisplacedPartsAreSortedByStampThenByFileOrder) {
    const auto log =
        read(text_of({flaser(30, "1 0.3"), flaser(10, "1 0.1"), flaser(20, "1 0.21"), flaser(20, "1 0.22")}));
    ASSERT_TRUE(log);
    EXPECT_EQ(first_ranges(*log), (std::vector<RangeMm>{100, 210, 220, 300}));
    EXPECT_FALSE(log->stamps.file_order);
    EXPECT_EQ(log->stamps.steps_back, 1U);
    EXPECT_DOUBLE_EQ(log->stamps.back_max, 20.0);
}

TEST_F(CarmenLogFile, ScansAfterTheClockWasSetBackStayWhereTheyAre) {
    const auto log =
        read(text_of({flaser(10, "1 0.1"), flaser(20, "1 0.2"), flaser(12, "1 0.3"), flaser(22, "1 0.4")}));
    ASSERT_TRUE(log);
    EXPECT_EQ(first_ranges(*log), (std::vector<RangeMm>{100, 200, 300, 400}));
    EXPECT_TRUE(log->stamps.file_order);
    EXPECT_TRUE(log->stamps.is_clock_set_back);
}

TEST_F(CarmenLogFile, JitteringStampsKeepTheFileOrder) {
    const auto log = read(text_of({flaser(3, "1 0.1"), flaser(1, "1 0.2"), flaser(2, "1 0.3"), flaser(1.5, "1 0.4")}));
    ASSERT_TRUE(log);
    EXPECT_EQ(first_ranges(*log), (std::vector<RangeMm>{100, 200, 300, 400}));
    EXPECT_TRUE(log->stamps.file_order);
    EXPECT_EQ(log->stamps.steps_back, 2U);
    EXPECT_DOUBLE_EQ(log->stamps.back_max, 2.0);
}

TEST_F(CarmenLogFile, LineWithoutStampUsesThePreviousStamp) {
    const auto log = read(text_of({flaser(5), "FLASER 1 0.7 0 0 0 0 0 0\n", flaser(1)}));
    EXPECT_EQ(log->observations[1].scan.stamp, 5.0);
    EXPECT_EQ(log->observations[2].scan.stamp, 5.0);
    EXPECT_EQ(log->observations[2].scan.ranges[0], 700U);
}

TEST_F(CarmenLogFile, BrokenLinesAreSkippedCountedAndReported) {
    const auto log = read(text_of({flaser(1), "FLASER 3 1 2\n", flaser(2), "FLASER 1 1.0 nan 0 0 0 0 0 3 host 3\n"}));
    ASSERT_TRUE(log);
    EXPECT_EQ(log->observations.size(), 2U);
    EXPECT_EQ(log->skipped_lines, 2U);
    ASSERT_EQ(skipped_.size(), 2U);
    EXPECT_EQ(skipped_[0].line_number, 2U);
    EXPECT_THAT(skipped_[0].reason, HasSubstr("3 beams are announced"));
    EXPECT_EQ(skipped_[1].line_number, 4U);
}

TEST_F(CarmenLogFile, UnsupportedLaserLinesAreCountedAndReportedOncePerKind) {
    const auto log = read(
        text_of({"RLASER 1 1.0 0 0 0 0 0 0 1 host 1\n", flaser(1), "LASER3 1 1.0 1 host 1\n",
                 "RLASER 1 1.0 0 0 0 0 0 0 2 host 2\n", "RAWLASER2 0 0 3 0.1 30 0 0 1 1.0 0\n", "POSITION 1 2 3\n"}));
    ASSERT_TRUE(log);
    EXPECT_EQ(log->observations.size(), 1U);
    EXPECT_EQ(log->skipped_lines, 4U);
    ASSERT_EQ(skipped_.size(), 3U);
    EXPECT_THAT(skipped_[0].reason, testing::StartsWith("LASER3: 1 lines of an unsupported kind"));
    EXPECT_EQ(skipped_[0].line_number, 3U);
    EXPECT_THAT(skipped_[1].reason, testing::StartsWith("RAWLASER2: 1 lines"));
    EXPECT_THAT(skipped_[2].reason, testing::StartsWith("RLASER: 2 lines"));
    EXPECT_EQ(skipped_[2].line_number, 1U);
    EXPECT_EQ(log->fingerprint, read(flaser(1))->fingerprint);
}

TEST_F(CarmenLogFile, ByteOrderMarkIsIgnored) {
    const auto text = text_of({flaser(1), flaser(2)});
    for (const auto& bytes : {"\xEF\xBB\xBF" + text, gzip("\xEF\xBB\xBF" + text)}) {
        const auto log = read(bytes);
        ASSERT_TRUE(log);
        EXPECT_EQ(log->observations.size(), 2U);
        EXPECT_EQ(log->fingerprint, read(text)->fingerprint);
    }
}

TEST_F(CarmenLogFile, FlaserPoseIsTheFirstTripleAndOdometryIsTheSecond) {
    const auto log = read("FLASER 1 1.0 1 2 0.5 3 4 0.7 9.5 host 1\n");
    const auto& [sensor, scan] = log->observations[0];
    EXPECT_EQ(scan.pose, (Pose2{1, 2, 0.5}));
    EXPECT_EQ(scan.odometry, (Pose2{3, 4, 0.7}));
    EXPECT_EQ(sensor->mount, Pose2{});
    EXPECT_EQ(sensor->range_max, kCarmenRangeMax);
}

TEST_F(CarmenLogFile, RangesAreMillimetresOrInvalid) {
    const auto log = read(flaser(1, "6 1.2345 0 -1 nan -inf 0.0004"));
    EXPECT_EQ(log->observations[0].scan.ranges, (std::vector<RangeMm>{1235, 0, 0, 0, 0, 0}));
}

TEST_F(CarmenLogFile, InfiniteReadingIsANoReturn) {
    const std::string text = flaser(1, "2 1.0 inf");
    EXPECT_EQ(read(text)->observations[0].scan.ranges, (std::vector<RangeMm>{1000, 0}))
        << "no-returns of such logs are dropped by default";
    CarmenOptions free;
    free.no_return = NoReturn::kFree;
    EXPECT_EQ(read(text, free)->observations[0].scan.ranges, (std::vector<RangeMm>{1000, kNoReturn}));
}

TEST_F(CarmenLogFile, FlaserDropsNoReturnsByDefault) {
    const std::string text = flaser(1, "4 49.9994 49.9996 50 81.83");
    EXPECT_EQ(read(text)->observations[0].scan.ranges, (std::vector<RangeMm>{49999, 0, 0, 0}));
    CarmenOptions free;
    free.no_return = NoReturn::kFree;
    EXPECT_EQ(read(text, free)->observations[0].scan.ranges,
              (std::vector<RangeMm>{49999, kNoReturn, kNoReturn, kNoReturn}));
}

TEST_F(CarmenLogFile, RangeMaxIsLimitedByTheLine) {
    CarmenOptions far;
    far.range_max = 1000.0;
    EXPECT_EQ(read(robot_laser("0 0 0", "0 0 0", 5.0), far)->observations[0].sensor->range_max, 5.0);
    EXPECT_EQ(read(robot_laser("0 0 0", "0 0 0", 80.0), far)->observations[0].sensor->range_max, 80.0);
    EXPECT_EQ(read(robot_laser("0 0 0", "0 0 0", 80.0))->observations[0].sensor->range_max, kCarmenRangeMax);
}

TEST_F(CarmenLogFile, RobotLaserKeepsNoReturnsByDefault) {
    const std::string text = robot_laser("0 0 0", "0 0 0", 30.0);
    const auto log = read(text);
    EXPECT_EQ(log->observations[0].scan.ranges, (std::vector<RangeMm>{1000, kNoReturn}));
    EXPECT_EQ(log->observations[0].sensor->range_max, 30.0);
    CarmenOptions drop;
    drop.no_return = NoReturn::kDrop;
    EXPECT_EQ(read(text, drop)->observations[0].scan.ranges[1], kInvalidRange);
}

TEST_F(CarmenLogFile, MaximumRangeOptionOverridesTheLog) {
    CarmenOptions options;
    options.range_max = 1.5;
    const auto log = read(text_of({flaser(1, "2 1.0 2.0"), robot_laser("0 0 0", "0 0 0", 30.0)}), options);
    EXPECT_EQ(log->observations[0].sensor->range_max, 1.5);
    EXPECT_EQ(log->observations[0].scan.ranges, (std::vector<RangeMm>{1000, kInvalidRange}));
    EXPECT_EQ(log->observations[1].scan.ranges, (std::vector<RangeMm>{1000, kNoReturn}));
}

TEST_F(CarmenLogFile, PoseTimesMountIsTheLoggedLaserPose) {
    // The second line differs by the rounding of six decimals, the third by a movement of the laser.
    const auto log =
        read(text_of({robot_laser("1.25 2.5 0.3", "1.0 2.4 0.31"), robot_laser("1.250001 2.5 0.3", "1.0 2.4 0.31"),
                      robot_laser("1.35 2.5 0.3", "1.0 2.4 0.31")}));
    ASSERT_EQ(log->observations.size(), 3U);
    const double laser_x[] = {1.25, 1.250001, 1.35};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& [sensor, scan] = log->observations[i];
        const Pose2 laser = compose(*scan.pose, sensor->mount);
        EXPECT_NEAR(laser.x, laser_x[i], 1e-12);
        EXPECT_NEAR(laser.y, 2.5, 1e-12);
        EXPECT_NEAR(laser.yaw, 0.3, 1e-12);
        EXPECT_NEAR(scan.pose->x, 1.0, 1e-5);
        EXPECT_NEAR(scan.pose->yaw, 0.31, 1e-5);
    }
    EXPECT_EQ(log->observations[0].sensor, log->observations[1].sensor);
    EXPECT_NE(log->observations[0].sensor, log->observations[2].sensor);
}

TEST_F(CarmenLogFile, BeamCountMayVaryWithOneSensorDescription) {
    const auto log =
        read(text_of({robot_laser("0 0 0", "0 0 0"),
                      "ROBOTLASER1 0 -1.5 3 0.1 30 0.01 0 3 1 1 1 0 0 0 0 0 0 0 0 0 0 0 0 14.0 host 13.1\n"}));
    EXPECT_EQ(log->observations[0].sensor, log->observations[1].sensor);
    EXPECT_EQ(log->observations[1].scan.ranges.size(), 3U);
}

TEST_F(CarmenLogFile, RawLaserPoseIsInterpolatedFromOdometry) {
    const auto log = read(text_of({"PARAM robot_frontlaser_offset 0.1 1 h 1\nODOM 2 4 3.1 0 0 0 10.25 h 1\n", kRawLaser,
                                   "ODOM 4 8 -3.1 0 0 0 10.75 h 1\n"}));
    ASSERT_TRUE(log);
    const auto& [sensor, scan] = log->observations[0];
    EXPECT_NEAR(scan.pose->x, 3.0, 1e-12);
    EXPECT_NEAR(scan.pose->y, 6.0, 1e-12);
    EXPECT_NEAR(std::abs(scan.pose->yaw), 3.14159, 1e-4) << "the yaw is interpolated along the shorter arc";
    EXPECT_EQ(sensor->mount, (Pose2{0.1, 0, 0}));
}

TEST_F(CarmenLogFile, RawLaserWithoutNearbyOdometryIsSkipped) {
    const auto log = read(text_of({"ODOM 2 4 0 0 0 0 8 h 1\n", kRawLaser}));
    ASSERT_FALSE(log);
    EXPECT_THAT(skipped_.at(0).reason, HasSubstr("no ODOM line within 1 s"));
}

TEST_F(CarmenLogFile, RawLaserIsIgnoredNextToRobotLaser) {
    const auto log = read(text_of({robot_laser("0 0 0", "0 0 0"), "ODOM 2 4 0 0 0 0 10.5 h 1\n", kRawLaser}));
    EXPECT_EQ(log->observations.size(), 1U);
    EXPECT_EQ(log->skipped_lines, 0U);
}

TEST_F(CarmenLogFile, FileWithoutScansIsRefusedByName) {
    for (const std::string_view text : {"", "# only\n", "FLASER 3 1 2\n", "\x01\x02\x03"}) {
        const auto log = read(text);
        ASSERT_FALSE(log);
        EXPECT_THAT(log.error().message, HasSubstr(text.empty() ? "the file is empty" : "no usable scan"));
        EXPECT_THAT(log.error().message, HasSubstr("FileWithoutScans"));
    }
}

TEST_F(CarmenLogFile, DamagedCompressedFileIsRefusedByName) {
    std::string text;
    for (int i = 0; i < 20000; ++i) text += flaser(0.37 * i);
    for (const std::string& whole : {gzip(text), bzip2(text)}) {
        for (const std::size_t cut : {whole.size() - 1, whole.size() / 2, std::size_t{30}, std::size_t{5}}) {
            const auto log = read(std::string_view(whole).substr(0, cut));
            ASSERT_FALSE(log) << "cut after " << cut << " of " << whole.size();
            EXPECT_THAT(log.error().message, HasSubstr("damaged or truncated: "));
        }
        std::string flipped = whole;
        flipped[whole.size() / 2] = static_cast<char>(flipped[whole.size() / 2] ^ 0x10);
        const auto log = read(flipped);
        ASSERT_FALSE(log);
        EXPECT_THAT(log.error().message, HasSubstr("DamagedCompressedFile"));
    }
}

TEST_F(CarmenLogFile, TextBeyondTheLimitIsRefused) {
    CarmenOptions options;
    options.limits.text_bytes_max = 100'000;
    const auto log = read(gzip(std::string(10'000'000, '\n')), options);
    ASSERT_FALSE(log);
    EXPECT_EQ(log.error().code, Errc::kTooLarge);
}

TEST_F(CarmenLogFile, TooLongLineIsRefused) {
    const auto log = read(text_of({flaser(1), std::string(2'000'000, 'x')}));
    ASSERT_FALSE(log);
    EXPECT_EQ(log.error().code, Errc::kTooLarge);
    EXPECT_THAT(log.error().message, HasSubstr("after line 1"));
}

TEST_F(CarmenLogFile, PartsInReverseOrderAreSorted) {
    std::string text;
    for (int part = 99; part >= 0; --part) {
        for (int n = 5 * part + 1; n <= 5 * part + 5; ++n) text += flaser(3 * n, fmt::format("1 {}", n * 0.001));
    }
    const auto log = read(text);
    ASSERT_TRUE(log);
    ASSERT_EQ(log->observations.size(), 500U);
    for (std::size_t i = 0; i < 500; ++i) EXPECT_EQ(log->observations[i].scan.ranges[0], i + 1);
}

TEST_F(CarmenLogFile, ScanCountIsKnownAfterOpening) {
    const auto path = write(text_of({flaser(1), "FLASER 3 1 2\n", robot_laser("0 0 0", "0 0 0", 0.0), flaser(2)}));
    auto log = CarmenLog::open(path, {}, [](const SkippedLine&) {});
    ASSERT_TRUE(log);
    EXPECT_EQ(log->scan_count(), 2U);
    EXPECT_EQ(log->skipped_lines(), 2U) << "a broken line and a line whose laser range is unknown";
    EXPECT_TRUE(*log->next());
    EXPECT_TRUE(*log->next());
    EXPECT_FALSE(*log->next());
    EXPECT_FALSE(*log->next()) << "further calls return the end again";
}

TEST_F(CarmenLogFile, OpeningReportsProgress) {
    const std::string text = text_of({flaser(1), flaser(2)});
    const auto path = write(text);
    ReadProgress last;
    ASSERT_TRUE(CarmenLog::open(
        path, {}, [](const SkippedLine&) {}, [&](const ReadProgress& progress) { last = progress; }));
    EXPECT_EQ(last.bytes, text.size());
    EXPECT_EQ(last.bytes_total, text.size());
}

TEST_F(CarmenLogFile, FileChangedWhileReadingIsAnError) {
    const auto path = write(text_of({flaser(1), flaser(2), flaser(3)}));
    for (const std::string& changed : {flaser(1), text_of({flaser(1), robot_laser("0 0 0", "0 0 0", 0.0), flaser(3)}),
                                       text_of({flaser(1), std::string_view("# a comment\n")})}) {
        write(text_of({flaser(1), flaser(2), flaser(3)}));
        auto log = CarmenLog::open(path, {}, [](const SkippedLine&) {});
        ASSERT_TRUE(log);
        write(changed);
        auto scan = log->next();
        while (scan && *scan) scan = log->next();
        ASSERT_FALSE(scan) << changed;
        EXPECT_EQ(scan.error().code, Errc::kConflict);
        EXPECT_THAT(scan.error().message, HasSubstr("was changed during the transfer"));
    }
}

TEST_F(CarmenLogFile, MissingFilesAndFoldersAreErrors) {
    const auto ignore = [](const SkippedLine&) {};
    EXPECT_EQ(read_whole_log("/nonexistent/x.clf", {}, ignore).error().code, Errc::kNotFound);
    EXPECT_THAT(read_whole_log(testing::TempDir(), {}, ignore).error().message, HasSubstr("not a regular file"));
}

} // namespace
} // namespace scanloom::robot

#include "robot_client/sources/sonar_log.hpp"

#include "tests/support/angles.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>
#include <utility>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

class SonarLogs : public testing::Test {
protected:
    Result<SonarLog> open(std::string_view measurements, std::string_view poses, const SonarOptions& options = {}) {
        return SonarLog::open(file("m.txt", measurements), file("p.txt", poses), options);
    }

    std::string error_of(std::string_view measurements, std::string_view poses) {
        const auto log = open(measurements, poses);
        return log ? "no error" : log.error().message;
    }

private:
    std::filesystem::path file(const char* name, std::string_view text) {
        const auto path = directory_.path() / name;
        std::ofstream(path, std::ios::binary) << text;
        return path;
    }

    TemporaryDirectory directory_;
};

TEST_F(SonarLogs, LineIsAScanOfEightSonars) {
    auto log = open("1000 1500 5110 5109 1 0 -3 2000.4 6000\n", "1000 2000 -1000 900\n");
    ASSERT_TRUE(log) << log.error().message;
    EXPECT_EQ(log->scan_count(), 1U);
    const auto observation = **log->next();
    EXPECT_THAT(observation.scan.ranges,
                ElementsAre(1500, kNoReturn, 5109, 1, kInvalidRange, kInvalidRange, 2000, kNoReturn));
    EXPECT_EQ(observation.scan.stamp, 1.0);
    EXPECT_NEAR(observation.scan.pose->x, 2.0, 1e-12);
    EXPECT_NEAR(observation.scan.pose->y, -1.0, 1e-12);
    EXPECT_NEAR(observation.scan.pose->yaw, std::numbers::pi / 2.0, 1e-12);
    const Sensor& ring = *observation.sensor;
    EXPECT_EQ(ring.kind, SensorKind::kSonar);
    EXPECT_EQ(ring.range_max, 5.11);
    EXPECT_NEAR(ring.aperture, 30.0 * kDegree, 1e-12);
    EXPECT_EQ(beam_count(ring.angles), 8U);
    EXPECT_NEAR(beam_angle(ring.angles, 0), -90.0 * kDegree, 1e-12);
    EXPECT_NEAR(beam_angle(ring.angles, 6), 37.5 * kDegree, 1e-12);
    EXPECT_FALSE(*log->next());
}

TEST_F(SonarLogs, PosesAreTheOdometryIfTheRobotSaysSo) {
    const auto log_with = [&](Poses poses) {
        SonarOptions options;
        options.poses = poses;
        return open("1000 1 1 1 1 1 1 1 1\n", "1000 2000 -1000 900\n", options).value();
    };
    auto map = log_with(Poses::kMap);
    auto odometry = log_with(Poses::kOdometry);
    EXPECT_NE(odometry.fingerprint(), map.fingerprint());
    const Scan scan = (*odometry.next())->scan;
    EXPECT_FALSE(scan.pose);
    EXPECT_EQ(scan.odometry, (*map.next())->scan.pose);
}

TEST_F(SonarLogs, PosesAreInterpolatedAlsoAcrossTheAngleWrap) {
    auto log = open("1250 1 1 1 1 1 1 1 1\n\n2000 1 1 1 1 1 1 1 1\r\n", "1000 0 0 3590\n2000 1000 400 30\n");
    const Pose2 between = *(*log->next())->scan.pose;
    EXPECT_NEAR(between.x, 0.25, 1e-12);
    EXPECT_NEAR(between.y, 0.1, 1e-12);
    EXPECT_NEAR(between.yaw, 0.0, 1e-12);
    EXPECT_NEAR((*log->next())->scan.pose->yaw, 3.0 * kDegree, 1e-12);
}

TEST_F(SonarLogs, OptionsSetRangeApertureAndNoReturns) {
    const SonarOptions options{.no_return = NoReturn::kDrop, .range_max = 3.0, .aperture = 0.2, .limits = {}};
    auto log = open("0 3000 2999 1 1 1 1 1 1\n", "0 0 0 0\n", options);
    const auto observation = **log->next();
    EXPECT_EQ(observation.scan.ranges[0], kInvalidRange);
    EXPECT_EQ(observation.scan.ranges[1], 2999U);
    EXPECT_EQ(observation.sensor->range_max, 3.0);
    EXPECT_EQ(observation.sensor->aperture, 0.2);
}

TEST_F(SonarLogs, ErrorsContainFileAndLine) {
    const char* good = "0 1 1 1 1 1 1 1 1\n";
    EXPECT_THAT(error_of("0 1 1 1 1 1 1 1 1\n\n100 1 2 3\n", "0 0 0 0\n"),
                EndsWith("m.txt:3: 4 values; 9 are needed: time_ms and 8 ranges in mm"));
    EXPECT_THAT(error_of("0 1 1 1 1 1 1 1 1 1\n", "0 0 0 0\n"), HasSubstr("m.txt:1: 10 values"));
    EXPECT_THAT(error_of("0 1 1 1 1 x\x1b 1 1 1\n", "0 0 0 0\n"), EndsWith("m.txt:1: 'x?' is not a number"));
    EXPECT_THAT(error_of("0 1 1 1 1 inf 1 1 1\n", "0 0 0 0\n"), EndsWith("m.txt:1: 'inf' is not finite"));
    EXPECT_THAT(error_of(good, "0 0 0\n"), HasSubstr("p.txt:1: 3 values; 4 are needed"));
    EXPECT_THAT(error_of(good, "0 0 0 0\n1 2e9 0 0\n"), HasSubstr("p.txt:2: the pose is more than"));
    EXPECT_THAT(error_of("0 1 1 1 1 1 1 1 1\n1001 1 1 1 1 1 1 1 1\n", "0 0 0 0\n"),
                testing::AllOf(HasSubstr("m.txt:2: "), EndsWith("p.txt has no pose within 1 s of its time")));
    EXPECT_THAT(error_of("\n", "0 0 0 0\n"), HasSubstr("m.txt: the file is empty"));
    EXPECT_THAT(error_of(good, ""), HasSubstr("p.txt: the file is empty"));
    const auto missing = SonarLog::open("/nonexistent/m.txt", "/nonexistent/p.txt", {});
    EXPECT_THAT(missing.error().message, HasSubstr("/nonexistent/p.txt"));
}

TEST_F(SonarLogs, FingerprintDependsOnEverythingThatDeterminesScans) {
    const auto fingerprint = [&](std::string_view m, std::string_view p, const SonarOptions& options = {}) {
        return open(m, p, options)->fingerprint();
    };
    const char* m = "0 1 1 1 1 1 1 1 1\n";
    const char* p = "0 0 0 0\n";
    EXPECT_EQ(fingerprint(m, p), fingerprint(m, p));
    const std::set<std::string> seen{fingerprint(m, p),
                                     fingerprint("0 2 1 1 1 1 1 1 1\n", p),
                                     fingerprint(m, "0 1 0 0\n"),
                                     fingerprint(m, p, {.range_max = 4.0, .limits = {}}),
                                     fingerprint(m, p, {.aperture = 0.3, .limits = {}}),
                                     fingerprint(m, p, {.no_return = NoReturn::kDrop, .limits = {}})};
    EXPECT_EQ(seen.size(), 6U);
    EXPECT_LE(seen.begin()->size(), 64U);
}

/// Returns the number of 0.2 m cells that contain echoes of the real ring, for the given signs of heading and ring
/// angle.
std::size_t cells_hit(SonarLog log, double heading_sign, double ring_sign) {
    std::set<std::pair<int, int>> cells;
    for (;;) {
        const auto observation = log.next();
        if (!*observation) return cells.size();
        const auto& [sensor, scan] = **observation;
        for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
            if (scan.ranges[beam] == kNoReturn) continue;
            const double yaw = heading_sign * scan.pose->yaw + ring_sign * beam_angle(sensor->angles, beam);
            cells.emplace(
                static_cast<int>(std::floor((scan.pose->x + scan.ranges[beam] * 1e-3 * std::cos(yaw)) * 5.0)),
                static_cast<int>(std::floor((scan.pose->y + scan.ranges[beam] * 1e-3 * std::sin(yaw)) * 5.0)));
        }
    }
}

TEST(RealSonar, EchoesAreConsistentWithTheAnglesAsRead) {
    const auto folder = std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/sonar";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "there is no " << folder;
    const auto open = [&] { return SonarLog::open(folder / "measurement.txt", folder / "poses.txt", {}); };
    ASSERT_TRUE(open()) << open().error().message;
    EXPECT_EQ(open()->scan_count(), 413U);
    const std::size_t as_read = cells_hit(*open(), 1.0, 1.0);
    EXPECT_LT(as_read, 560U);
    EXPECT_GT(cells_hit(*open(), 1.0, -1.0), as_read + 50);
    EXPECT_GT(cells_hit(*open(), -1.0, 1.0), as_read + 50);
    EXPECT_GT(cells_hit(*open(), -1.0, -1.0), as_read + 50);
}

} // namespace
} // namespace scanloom::robot

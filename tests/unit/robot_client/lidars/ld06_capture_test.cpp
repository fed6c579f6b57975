#include "robot_client/lidars/ld06_capture.hpp"

#include "tests/support/ld06_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using testing_support::Bytes;
using testing_support::Ld06Spinner;

class Ld06Captures : public testing::Test {
protected:
    std::filesystem::path file(const Bytes& bytes) {
        const auto path = directory_.path() / "capture.bin";
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return path;
    }

    static std::vector<Scan> scans_of(Ld06Capture& capture) {
        std::vector<Scan> scans;
        for (auto next = capture.next();; next = capture.next()) {
            if (!next) ADD_FAILURE() << next.error().message;
            if (!next || !*next) return scans;
            scans.push_back((*next)->scan);
        }
    }

    static PoseTimeline straight_line(double begin, double end) {
        PoseTimeline poses;
        for (const double t : {begin, end}) poses.insert({{t, 0.0, 0.0}, t});
        return poses;
    }

private:
    TemporaryDirectory directory_;
};

TEST_F(Ld06Captures, GiveOneScanPerTurnAtTheGivenPose) {
    Ld06Spinner sensor;
    auto capture = Ld06Capture::open(file(sensor.next_bytes(400)), {}, Pose2{1.0, 2.0, 3.0});
    ASSERT_TRUE(capture) << capture.error().message;
    EXPECT_EQ(capture->scan_count(), 9U); // 4800 points, without the first turn and the points after the last crossing
    EXPECT_EQ(capture->remarks(), "0 damaged packets, 9 turns");
    const auto scans = scans_of(*capture);
    ASSERT_EQ(scans.size(), 9U);
    for (const auto& scan : scans) {
        EXPECT_EQ(scan.pose, (Pose2{1.0, 2.0, 3.0}));
        EXPECT_EQ(scan.ranges.size(), 450U);
        EXPECT_EQ(scan.ranges.back(), 1000U) << "the last beam points ahead";
    }
    EXPECT_NEAR(scans[3].stamp - scans[2].stamp, 0.1, 0.003);
    EXPECT_FALSE(capture->next().value()) << "further calls return the end again";
}

TEST_F(Ld06Captures, UseThePoseAtTheMiddleOfTheTurn) {
    Ld06Spinner sensor(0, 29'900); // the sensor's clock wraps
    auto capture = Ld06Capture::open(file(sensor.next_bytes(400)), {}, straight_line(0.25, 0.75));
    ASSERT_TRUE(capture) << capture.error().message;
    EXPECT_EQ(capture->scan_count(), 5U);
    EXPECT_EQ(capture->remarks(), "0 damaged packets, 9 turns, 4 scans skipped without a pose");
    for (const auto& scan : scans_of(*capture)) EXPECT_DOUBLE_EQ(scan.pose->x, scan.stamp);
}

TEST_F(Ld06Captures, AreDeterministic) {
    Ld06Spinner sensor;
    Bytes bytes = sensor.next_bytes(200);
    for (std::size_t at = 20; at < bytes.size(); at += 555) bytes[at] ^= 0x10;
    const auto path = file(bytes);
    auto first = Ld06Capture::open(path, {}, Pose2{});
    auto second = Ld06Capture::open(path, {}, Pose2{});
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->fingerprint(), second->fingerprint());
    EXPECT_THAT(first->remarks(), HasSubstr("17 damaged packets"));
    EXPECT_EQ(scans_of(*first), scans_of(*second));
}

TEST_F(Ld06Captures, PosesAreOdometryOrAbsentIfTheRobotSaysSo) {
    Ld06Spinner sensor;
    const Bytes bytes = sensor.next_bytes(400);
    auto odometry = Ld06Capture::open(file(bytes), {.poses = Poses::kOdometry}, straight_line(0.0, 10.0));
    ASSERT_TRUE(odometry) << odometry.error().message;
    for (const auto& scan : scans_of(*odometry)) {
        EXPECT_FALSE(scan.pose);
        ASSERT_TRUE(scan.odometry);
        EXPECT_DOUBLE_EQ(scan.odometry->x, scan.stamp);
    }
    auto none = Ld06Capture::open(file(bytes), {.poses = Poses::kNone}, Pose2{});
    ASSERT_TRUE(none) << none.error().message;
    EXPECT_EQ(none->scan_count(), 9U);
    for (const auto& scan : scans_of(*none)) EXPECT_FALSE(scan.pose || scan.odometry);
}

TEST_F(Ld06Captures, FingerprintDependsOnEverythingThatChangesScans) {
    Ld06Spinner sensor;
    const Bytes bytes = sensor.next_bytes(200);
    std::set<std::string> seen;
    const auto add = [&](const LidarScanOptions& options, LidarPoses poses) {
        const auto capture = Ld06Capture::open(file(bytes), options, std::move(poses));
        ASSERT_TRUE(capture) << capture.error().message;
        EXPECT_LE(capture->fingerprint().size(), 64U);
        EXPECT_THAT(capture->fingerprint(), StartsWith("ld06:"));
        EXPECT_TRUE(seen.insert(capture->fingerprint()).second);
    };
    add({}, Pose2{});
    add({}, Pose2{1e-9, 0.0, 0.0});
    add({}, straight_line(0.0, 10.0));
    add({}, straight_line(0.0, 10.5));
    add({.range_min = 0.03}, Pose2{});
    add({.range_max = 11.0}, Pose2{});
    add({.no_return = NoReturn::kDrop}, Pose2{});
    add({.confidence_min = 99}, Pose2{});
    add({.median_window = 3}, Pose2{});
    add({.mount = {0.0, 0.1, 0.0}}, Pose2{});
    add({.poses = Poses::kOdometry}, straight_line(0.0, 10.0));
    add({.poses = Poses::kNone}, Pose2{});
    Bytes other = bytes;
    other.pop_back();
    EXPECT_TRUE(seen.insert(Ld06Capture::open(file(other), {}, Pose2{}).value().fingerprint()).second);
}

TEST_F(Ld06Captures, WithoutScansAreRefusedWithTheReason) {
    Ld06Spinner sensor;
    EXPECT_THAT(Ld06Capture::open(file(sensor.next_bytes(60)), {}, Pose2{}).error().message,
                HasSubstr("no full turn of an LD06 (60 packets)"));
    EXPECT_THAT(Ld06Capture::open(file({}), {}, Pose2{}).error().message, HasSubstr("(0 packets)"));
    EXPECT_THAT(Ld06Capture::open(file(sensor.next_bytes(200)), {}, straight_line(1.7e9, 1.8e9)).error().message,
                HasSubstr("no scan is within the time range of the poses"));
    EXPECT_THAT(Ld06Capture::open("/nonexistent/capture.bin", {}, Pose2{}).error().message,
                HasSubstr("cannot be opened: No such file"));
}

TEST_F(Ld06Captures, FailIfTheFileChangesWhileReading) {
    for (const int packets : {100, 300}) {
        Ld06Spinner sensor;
        auto capture = Ld06Capture::open(file(sensor.next_bytes(200)), {}, Pose2{});
        ASSERT_TRUE(capture);
        Ld06Spinner other;
        file(other.next_bytes(packets));
        auto next = capture->next();
        while (next && *next) next = capture->next();
        ASSERT_FALSE(next) << packets;
        EXPECT_EQ(next.error().code, Errc::kConflict);
    }
}

TEST_F(Ld06Captures, RealRecordingGivesCompleteTurns) {
    const std::filesystem::path path = SCANLOOM_SOURCE_DIR "/../shared/data/ld06/capture.bin";
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "recorded data, no part of the project, are not on this machine: " << path;
    auto capture = Ld06Capture::open(path, {}, Pose2{});
    ASSERT_TRUE(capture) << capture.error().message;
    EXPECT_EQ(capture->remarks(), "3 damaged packets, 225 turns, 4 of them cut by 2 gaps");
    const auto scans = scans_of(*capture);
    ASSERT_EQ(scans.size(), 225U);
    std::size_t whole = 0;
    for (const auto& scan : scans) {
        EXPECT_LE(scan.ranges.size(), 470U);
        whole += scan.ranges.size() >= 440;
        const auto& steps = std::get<SteppedAngles>(*scan.angles).steps;
        EXPECT_TRUE(std::ranges::is_sorted(steps, std::less_equal())) << "steps ascend strictly";
    }
    EXPECT_GE(whole, 220U) << "all turns except those at the seams of the recording are complete";
}

} // namespace
} // namespace scanloom::robot

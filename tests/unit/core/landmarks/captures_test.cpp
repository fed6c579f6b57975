#include "core/landmarks/captures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scanloom::landmarks {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// Four beams: ahead, left, behind, right.
const Sensor kLaser{.id = 1,
                    .kind = SensorKind::kLaser,
                    .name = "laser",
                    .mount = {0.1, 0.0, 0.0},
                    .angles = UniformAngles{0.0, std::numbers::pi / 2, 4},
                    .aperture = 0.01,
                    .range_min = 0.1,
                    .range_max = 10.0};

/// Adds scans of one robot at intervals of 0.1 s; each scan is one log entry.
class Robot {
public:
    explicit Robot(CaptureCutter& cutter) : cutter_(cutter) {}

    std::optional<Capture> scan(const Pose2& pose, std::vector<RangeMm> ranges = {1000, 1000, 1000, 1000}) {
        Scan scan{.seq = revision_, .stamp = stamp_ += 0.1, .sensor = 1, .pose = pose, .ranges = std::move(ranges)};
        return cutter_.add(scan, kLaser, revision_++);
    }

    [[nodiscard]] double next_stamp() const { return stamp_ + 0.1; }
    void wait(double seconds) { stamp_ += seconds; }

private:
    CaptureCutter& cutter_;
    Revision revision_ = 10;
    double stamp_ = 100.0;
};

class CaptureTest : public testing::Test {
protected:
    CaptureCutter cutter_;
    Robot robot_{cutter_};
};

TEST_F(CaptureTest, DrivingRobotGetsOneCaptureOfOneScanPerHalfMetre) {
    std::vector<Revision> firsts;
    for (int step = 0; step < 100; ++step) {
        if (const auto ended = robot_.scan({step * 0.1, 0.0, 0.0})) {
            EXPECT_EQ(ended->scans, 1U);
            firsts.push_back(ended->first);
        }
    }
    ASSERT_THAT(firsts, SizeIs(20));
    for (std::size_t n = 0; n < firsts.size(); ++n) EXPECT_EQ(firsts[n], 10 + 5 * n);
}

TEST_F(CaptureTest, TurningRobotGetsOneCapturePerDirection) {
    int ended = 0;
    for (int step = 0; step < 60; ++step) ended += robot_.scan({0.0, 0.0, normalize_angle(step * 0.21)}) ? 1 : 0;
    EXPECT_EQ(ended, 20);
}

TEST_F(CaptureTest, StationaryRobotFillsOneCapture) {
    for (std::uint32_t n = 1; n < kCaptureScansMax; ++n) EXPECT_FALSE(robot_.scan({0.02 * (n % 2), 0.0, 0.01}));
    const auto full = robot_.scan({0.0, 0.0, 0.0});
    ASSERT_TRUE(full);
    EXPECT_EQ(full->scans, kCaptureScansMax);
    EXPECT_EQ(full->first, 10U);
    EXPECT_EQ(full->last, 10U + kCaptureScansMax - 1);
    EXPECT_THAT(full->points, SizeIs(4 * kCaptureScansMax));
    EXPECT_EQ(full->pose, (Pose2{0.02, 0.0, 0.01}));
    for (int n = 0; n < 100; ++n)
        EXPECT_FALSE(robot_.scan({0.0, 0.0, 0.0})) << "the robot has not moved since the last capture";
    EXPECT_EQ(cutter_.open(), nullptr);
}

TEST_F(CaptureTest, StationaryRobotStartsAnotherCaptureAfterAWhile) {
    for (std::uint32_t n = 0; n < kCaptureScansMax; ++n) static_cast<void>(robot_.scan({}));
    robot_.wait(kCaptureAgainAfter);
    EXPECT_FALSE(robot_.scan({}));
    EXPECT_NE(cutter_.open(), nullptr);
}

TEST_F(CaptureTest, MovementEndsACaptureAndAShortStepStartsNone) {
    EXPECT_FALSE(robot_.scan({}));
    EXPECT_FALSE(robot_.scan({}));
    const auto ended = robot_.scan({0.2, 0.0, 0.0});
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->scans, 2U);
    EXPECT_EQ(ended->last, 11U);
    EXPECT_EQ(cutter_.open(), nullptr);
    EXPECT_FALSE(robot_.scan({0.4, 0.0, 0.0}));
    EXPECT_EQ(cutter_.open(), nullptr);
    EXPECT_FALSE(robot_.scan({0.5, 0.0, 0.0}));
    EXPECT_NE(cutter_.open(), nullptr);
    const auto jumped = robot_.scan({7.5, 0.0, 0.0});
    ASSERT_TRUE(jumped);
    EXPECT_EQ(jumped->pose.x, 0.5);
    EXPECT_NE(cutter_.open(), nullptr) << "the next capture begins with the same scan";
}

/// Most scans of a long log can be skipped.
TEST_F(CaptureTest, NeedsPredictsIrrelevantScans) {
    const auto scan_at = [&](const Pose2& pose) {
        const bool needed = cutter_.needs(robot_.next_stamp(), pose);
        const auto open_before = cutter_.open() != nullptr;
        const auto ended = robot_.scan(pose);
        EXPECT_EQ(needed, open_before || ended || cutter_.open() != nullptr);
        return needed;
    };
    EXPECT_TRUE(scan_at({}));
    EXPECT_TRUE(scan_at({0.1, 0.0, 0.0})) << "the scan ends the first capture";
    for (int step = 2; step < 5; ++step) EXPECT_FALSE(scan_at({step * 0.1, 0.0, 0.0}));
    EXPECT_TRUE(scan_at({0.5, 0.0, 0.0}));
    EXPECT_TRUE(scan_at({0.6, 0.0, 0.0}));
    EXPECT_FALSE(scan_at({0.6, 0.0, 0.5}));
    EXPECT_TRUE(scan_at({0.6, 0.0, 0.7}));
    EXPECT_TRUE(scan_at({0.6, 0.0, 0.8}));
    EXPECT_FALSE(scan_at({0.6, 0.0, 0.8}));
    robot_.wait(kCaptureAgainAfter);
    EXPECT_TRUE(scan_at({0.6, 0.0, 0.8}));
}

TEST_F(CaptureTest, PointsAreBeamEndsInTheMapFrame) {
    static_cast<void>(robot_.scan({1.0, 2.0, std::numbers::pi / 2}, {2000, kNoReturn, kInvalidRange, 50}));
    const auto ended = robot_.scan({9.0, 9.0, 0.0}, {10'000, 3000, 0, 0});
    ASSERT_TRUE(ended);
    EXPECT_THAT(ended->points, ElementsAre(PointMm{1000, 4100}))
        << "no-returns, invalid readings and too near readings give no points";
    const auto next = robot_.scan({});
    ASSERT_TRUE(next);
    EXPECT_THAT(next->points, ElementsAre(PointMm{9100, 12'000})) << "a reading of range_max means no return";
}

} // namespace
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

Sensor sensor(std::uint32_t id, SensorKind kind, double mount_x) {
    return {.id = id,
            .kind = kind,
            .name = "s",
            .mount = {mount_x, 0.0, 0.0},
            .angles = UniformAngles{0.0, 1.0, 1},
            .aperture = 0.01,
            .range_min = 0.1,
            .range_max = 10.0};
}

ScanTaken scan(RobotIndex robot, double x, std::uint32_t of = 1) {
    return {robot, Scan{.seq = 1, .stamp = 1.0, .sensor = of, .pose = Pose2{x, 0.0, 0.0}, .ranges = {1000}}};
}

class SessionCapturesTest : public testing::Test {
protected:
    void SetUp() override {
        for (RobotIndex robot = 0; robot < 2; ++robot) {
            EXPECT_FALSE(captures_.add(RobotJoined{robot, "r"}));
            EXPECT_FALSE(captures_.add(SensorDescribed{robot, sensor(1, SensorKind::kLaser, 0.0)}));
        }
    }

    SessionCaptures captures_;
};

TEST_F(SessionCapturesTest, EachRobotHasItsOwnCaptures) {
    EXPECT_FALSE(captures_.add(scan(0, 0.0)));
    EXPECT_FALSE(captures_.add(scan(1, 9.0)));
    const auto first = captures_.add(scan(0, 1.0));
    ASSERT_TRUE(first);
    EXPECT_EQ(first->robot, 0U);
    EXPECT_EQ(first->capture.first, 5U) << "revisions count log entries";
    EXPECT_EQ(first->capture.last, 5U);
    EXPECT_EQ(first->ended, 7U) << "the capture ended when the robot moved on";
    EXPECT_THAT(first->capture.points, ElementsAre(PointMm{1000, 0}));
    const auto open = captures_.open();
    ASSERT_THAT(open, SizeIs(2));
    EXPECT_EQ(open[0].capture.first, 7U);
    EXPECT_EQ(open[1].ended, 7U) << "open captures end at the current revision";
    EXPECT_THAT(open[1].capture.points, ElementsAre(PointMm{10'000, 0}));
    EXPECT_EQ(captures_.revision(), 7U);
}

TEST_F(SessionCapturesTest, ScansUseTheSensorsNewestDescription) {
    static_cast<void>(captures_.add(scan(0, 0.0)));
    static_cast<void>(captures_.add(SensorDescribed{0, sensor(1, SensorKind::kLaser, 0.5)}));
    static_cast<void>(captures_.add(scan(0, 1.0)));
    EXPECT_THAT(captures_.open()[0].capture.points, ElementsAre(PointMm{2500, 0}));
}

TEST_F(SessionCapturesTest, IgnoresSonarsAndUnknownSensors) {
    static_cast<void>(captures_.add(SensorDescribed{0, sensor(2, SensorKind::kSonar, 0.0)}));
    for (const std::uint32_t of : {2U, 3U}) EXPECT_FALSE(captures_.add(scan(0, of, of)));
    EXPECT_FALSE(captures_.add(scan(7, 0.0)));
    EXPECT_THAT(captures_.open(), IsEmpty());
    EXPECT_EQ(captures_.revision(), 8U);
}

TEST_F(SessionCapturesTest, NeedsReturnsFalseForSkippableScans) {
    EXPECT_TRUE(captures_.needs({5, 1, 0.0, Pose2{}})) << "the robot has no scans yet";
    static_cast<void>(captures_.add(scan(0, 0.0)));
    static_cast<void>(captures_.add(scan(0, 0.1)));
    EXPECT_FALSE(captures_.needs({0, 3, 1.0, Pose2{0.2, 0.0, 0.0}}));
    EXPECT_TRUE(captures_.needs({0, 3, 1.0, Pose2{0.6, 0.0, 0.0}}));
    EXPECT_FALSE(captures_.needs({0, 3, 1.0, std::nullopt})) << "its pose is not known";
    captures_.pass_over({0, 3, 1.0, Pose2{}});
    EXPECT_EQ(captures_.revision(), 7U);
}

} // namespace
} // namespace scanloom::landmarks

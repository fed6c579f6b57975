#include "server/landmarks/session_captures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::landmarks {
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
    return {robot, Scan{.seq = 1, .stamp = 1.0, .sensor = of, .pose = {x, 0.0, 0.0}, .ranges = {1000}}};
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
    EXPECT_TRUE(captures_.needs({5, 1, 0.0, {}})) << "the robot has no scans yet";
    static_cast<void>(captures_.add(scan(0, 0.0)));
    static_cast<void>(captures_.add(scan(0, 0.1)));
    EXPECT_FALSE(captures_.needs({0, 3, 1.0, {0.2, 0.0, 0.0}}));
    EXPECT_TRUE(captures_.needs({0, 3, 1.0, {0.6, 0.0, 0.0}}));
    captures_.pass_over({0, 3, 1.0, {}});
    EXPECT_EQ(captures_.revision(), 7U);
}

} // namespace
} // namespace scanloom::landmarks

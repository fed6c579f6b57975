#include "core/landmarks/cloud_fusion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scanloom::landmarks {
namespace {

using testing::DoubleNear;
using testing::HasSubstr;
using testing::IsEmpty;

RobotCapture capture(RobotIndex robot, Pose2 pose, Revision last, std::vector<PointMm> points) {
    return {robot, Capture{.pose = pose, .scans = 1, .points = std::move(points)}, last};
}

TEST(SessionCloud, FusesPointsAndKeepsTheirFirstObserver) {
    const std::vector<RobotCapture> captures{
        capture(1, {1.0, 0.0, std::numbers::pi / 2}, 11, {{1000, 2000}, {3000, 0}}),
        capture(0, {0.0, 0.0, 0.0}, 12, {{1020, 2010}, {-5000, 0}}),
        capture(1, {1.0, 0.0, 0.0}, 13, {{1010, 1990}}),
    };
    const auto cloud = fuse_captures(captures, 0.05).value();
    ASSERT_EQ(cloud.size(), 3U);
    EXPECT_EQ(cloud[0].position, (Point2{1.01, 2.0}));
    EXPECT_EQ(cloud[0].seen, 3U);
    EXPECT_EQ(cloud[0].robot, 1U);
    EXPECT_EQ(cloud[0].revision, 11U);
    EXPECT_THAT(cloud[0].distance, DoubleNear(std::hypot(0.01, 2.0), 1e-12));
    EXPECT_THAT(cloud[0].angle, DoubleNear(-std::atan2(0.01, 2.0), 1e-12))
        << "the point is ahead of a robot that heads along y";
    EXPECT_THAT(cloud[1].angle, DoubleNear(-std::numbers::pi / 2, 1e-12)) << "the point is to its right";
    EXPECT_EQ(cloud[2].position, (Point2{-5.0, 0.0}));
    EXPECT_EQ(cloud[2].seen, 1U);
    EXPECT_EQ(cloud[2].robot, 0U);
    EXPECT_EQ(cloud[2].angle, std::numbers::pi);
}

TEST(SessionCloud, IsEmptyWithoutPointsAndRefusesInvalidThresholds) {
    EXPECT_THAT(fuse_captures({}, 0.05).value(), IsEmpty());
    EXPECT_THAT(fuse_captures(std::vector{capture(0, {}, 1, {})}, 0.05).value(), IsEmpty());
    const std::vector two{capture(0, {}, 1, {{1000, 0}}), capture(0, {}, 2, {{1000, 0}})};
    int calls = 0;
    const auto ended = fuse_captures(two, 0.05, [&]() -> Result<> {
        if (++calls == 1) return {};
        return Error{Errc::kShuttingDown, "enough"};
    });
    ASSERT_FALSE(ended);
    EXPECT_EQ(ended.error().message, "enough");
    EXPECT_THAT(fuse_captures({}, -1.0).error().message, HasSubstr("threshold"));
}

} // namespace
} // namespace scanloom::landmarks

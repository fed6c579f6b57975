#include "common/geometry/pose2.hpp"

#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <random>

namespace scanloom {
namespace {

TEST(Pose2, NormalizedAnglesAreInTheHalfOpenInterval) {
    EXPECT_DOUBLE_EQ(normalize_angle(kPi), kPi);
    EXPECT_DOUBLE_EQ(normalize_angle(-kPi), kPi);
    EXPECT_DOUBLE_EQ(normalize_angle(3.0 * kPi / 2.0), -kPi / 2.0);
    EXPECT_NEAR(normalize_angle(200.0 * kPi + 0.25), 0.25, 1e-12);
}

TEST(Pose2, ComposeRotatesThenTranslates) {
    const Pose2 T_map_robot{1.0, 2.0, kPi / 2.0};
    const Pose2 T_robot_sensor{0.5, 0.0, kPi};
    const Pose2 T_map_sensor = compose(T_map_robot, T_robot_sensor);
    EXPECT_NEAR(T_map_sensor.x, 1.0, 1e-12);
    EXPECT_NEAR(T_map_sensor.y, 2.5, 1e-12);
    EXPECT_NEAR(T_map_sensor.yaw, -kPi / 2.0, 1e-12);
}

TEST(Pose2, InverseOfAnyPoseComposesToIdentity) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> metres(-100.0, 100.0);
    std::uniform_real_distribution<double> radians(-10.0, 10.0);
    for (int i = 0; i < 1000; ++i) {
        const Pose2 pose{metres(random), metres(random), radians(random)};
        const Pose2 identity = compose(pose, inverse(pose));
        EXPECT_NEAR(identity.x, 0.0, 1e-9);
        EXPECT_NEAR(identity.y, 0.0, 1e-9);
        EXPECT_NEAR(identity.yaw, 0.0, 1e-9);
        const Point2 point{metres(random), metres(random)};
        EXPECT_LT(norm(transform(inverse(pose), transform(pose, point)) - point), 1e-9);
    }
}

} // namespace
} // namespace scanloom

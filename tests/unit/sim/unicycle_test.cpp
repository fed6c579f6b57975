#include "sim/simulator.hpp"

#include "sim/noise.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scanloom::sim {
namespace {

TEST(Unicycle, MovesStraightAndTurnsInPlace) {
    const Pose2 straight = moved({1, 2, kPi / 2}, {0.5, 0.0});
    EXPECT_NEAR(straight.x, 1.0, 1e-12);
    EXPECT_NEAR(straight.y, 2.5, 1e-12);
    EXPECT_EQ(moved({1, 2, 0.5}, {0.0, 0.25}), (Pose2{1, 2, 0.75}));
}

TEST(Unicycle, FullCircleInManyStepsReturnsToTheStart) {
    Pose2 pose{3, 4, 1};
    for (int i = 0; i < 100; ++i) pose = moved(pose, {0.02, 2.0 * kPi / 100.0});
    EXPECT_NEAR(pose.x, 3.0, 1e-9);
    EXPECT_NEAR(pose.y, 4.0, 1e-9);
    EXPECT_NEAR(pose.yaw, 1.0, 1e-9);
}

TEST(Unicycle, OneLongArcEqualsManyShortArcs) {
    const Pose2 once = moved({0, 0, 0}, {1.0, 0.8});
    Pose2 in_steps;
    for (int i = 0; i < 1000; ++i) in_steps = moved(in_steps, {0.001, 0.0008});
    EXPECT_NEAR(once.x, in_steps.x, 1e-9);
    EXPECT_NEAR(once.y, in_steps.y, 1e-9);
}

TEST(Unicycle, VelocitiesAreLimited) {
    const Motion motion = drive(make_room(), {-3.5, -3.5, 0}, {100.0, -100.0});
    EXPECT_DOUBLE_EQ(motion.forward, kForwardMax * kControlPeriod);
    EXPECT_DOUBLE_EQ(motion.turn, -kTurnMax * kControlPeriod);
}

TEST(Unicycle, RandomDrivesNeverEnterASolid) {
    for (const World& world : {make_room(), make_office()}) {
        Random random(3);
        Pose2 pose{world.floors[0].x_min + 1.0, world.floors[0].y_min + 1.0, 0.0};
        ASSERT_GT(clearance(world, {pose.x, pose.y}), kBodyRadius);
        Velocity wanted;
        int stopped = 0;
        for (int step = 0; step < 40'000; ++step) {
            if (step % 40 == 0) wanted = {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
            const Motion motion = drive(world, pose, wanted);
            stopped += motion.forward == 0.0;
            pose = moved(pose, motion);
            ASSERT_GE(clearance(world, {pose.x, pose.y}), kBodyRadius);
        }
        EXPECT_GT(stopped, 100) << "the robot must reach the walls";
    }
}

TEST(Unicycle, BlockedRobotCanTurn) {
    const Pose2 at_wall{-4.84, 0.0, kPi};
    const Motion motion = drive(make_room(), at_wall, {0.7, 0.5});
    EXPECT_EQ(motion.forward, 0.0);
    EXPECT_GT(motion.turn, 0.0);
}

} // namespace
} // namespace scanloom::sim

#include "server/guidance/goal_assignments.hpp"

#include <gtest/gtest.h>

namespace scanloom::guidance {
namespace {

constexpr double kCell = 0.1;

/// A robot at (1, 1) whose target is 2 m to the right.
Visit to_the_right() { return {{1.0, 1.0}, {3.0, 1.0}, arrival_radius(0.15, kCell), 4, std::nullopt}; }

mapping::RobotState robot_at(const Pose2& pose) {
    mapping::RobotState robot;
    robot.pose = pose;
    robot.scan_count = 5;
    return robot;
}

TEST(Visit, ArrivalRadiusIsBodyRadiusOrTwoCells) {
    EXPECT_EQ(arrival_radius(0.15, 0.05), 0.15);
    EXPECT_EQ(arrival_radius(0.15, 0.5), 1.0);
    EXPECT_TRUE(is_there(to_the_right(), robot_at({1.0, 1.19, 0.0})));
    EXPECT_FALSE(is_there(to_the_right(), robot_at({1.0, 1.21, 0.0})));
    EXPECT_FALSE(is_there(to_the_right(), {})) << "the robot's position is unknown";
}

TEST(Visit, HasLookedIfHeadingTowardsTheTarget) {
    const auto looks = [](const Pose2& pose) { return has_looked(to_the_right(), robot_at(pose), kCell); };
    EXPECT_TRUE(looks({1.0, 1.0, 0.0}));
    EXPECT_TRUE(looks({1.0, 1.0, 0.78}));
    EXPECT_TRUE(looks({1.0, 1.0, -0.78}));
    EXPECT_FALSE(looks({1.0, 1.0, 0.8}));
    EXPECT_FALSE(looks({1.0, 1.0, 3.14}));
    EXPECT_FALSE(looks({1.3, 1.0, 0.0})) << "the robot is not at its goal";
}

TEST(Visit, HasLookedAtANearTargetByBearingFromTheRobot) {
    Visit visit = to_the_right();
    visit.target = {1.1, 1.0};
    const double left = 3.14;
    EXPECT_TRUE(has_looked(visit, robot_at({1.19, 1.0, left}), kCell)) << "the robot stands beyond the target";
    EXPECT_FALSE(has_looked(visit, robot_at({1.0, 1.0, left}), kCell));
    EXPECT_TRUE(has_looked(visit, robot_at({1.1, 1.02, left}), kCell))
        << "the robot stands on the target, so no direction leads to it";
}

/// One scan per second with a heading away from the target. The robot makes requests from second 2 on.
mapping::RobotState standing(int until, int away_at = -1) {
    mapping::Trajectory trajectory;
    auto robot = robot_at({1.0, 1.0, 3.0});
    for (int second = 0; second <= until; ++second) {
        robot.stamp = second;
        trajectory.append({0, robot.stamp, second == away_at ? Pose2{9.0, 9.0, 0.0} : *robot.pose});
    }
    robot.trajectory = trajectory.snapshot();
    return robot;
}

TEST(Visit, HasLookedAfterFiveSecondsAtTheGoal) {
    Visit visit = to_the_right();
    EXPECT_FALSE(has_looked(visit, standing(100), kCell)) << "the robot has made no request from its goal";
    visit.asking_since = 2.0;
    EXPECT_FALSE(has_looked(visit, standing(6), kCell));
    EXPECT_TRUE(has_looked(visit, standing(7), kCell));
    EXPECT_FALSE(has_looked(visit, standing(7, 4), kCell)) << "the robot left its goal in between";
    EXPECT_FALSE(has_looked(visit, standing(9, 4), kCell));
    EXPECT_TRUE(has_looked(visit, standing(10, 4), kCell));
}

} // namespace
} // namespace scanloom::guidance

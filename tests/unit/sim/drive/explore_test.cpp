#include "sim/drive/explore.hpp"

#include "tests/unit/sim/drive/driven.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scanloom::sim {
namespace {

/// An exploring robot in a world; the test gives the goals.
struct Exploring {
    explicit Exploring(World world, const Pose2& start = {-2.0, 0.0, 0.0})
        : Exploring(std::make_unique<Explore>(), std::move(world), start) {}
    Exploring(std::unique_ptr<Explore> made, World world, const Pose2& start)
        : explore(made.get()), driven(std::move(world), start, std::move(made)) {}

    /// Runs until the robot requests a goal.
    /// @return whether it does so within `seconds`
    bool requests_goal_within(double seconds) {
        for (int n = 0; n < static_cast<int>(seconds / kScanPeriod) && !explore->needs_goal(); ++n)
            driven.run(kScanPeriod * 1.5);
        return explore->needs_goal();
    }

    [[nodiscard]] const Pose2& pose() const { return driven.simulator().pose(); }

    Explore* explore; // owned by the simulator
    Driven driven;
};

TEST(Explore, TurnsOnceBeforeTheFirstRequest) {
    Exploring robot(walled({}));
    EXPECT_FALSE(robot.explore->needs_goal());
    EXPECT_FALSE(robot.requests_goal_within(3.5));
    EXPECT_TRUE(robot.requests_goal_within(2.0));
    EXPECT_EQ(robot.driven.trajectory().back(), (Point2{-2.0, 0.0}));
}

TEST(Explore, FollowsThePathAndFacesTheTargetBeforeTheNextRequest) {
    Exploring robot(walled({}));
    ASSERT_TRUE(robot.requests_goal_within(6.0));
    robot.explore->go({{-2.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}, {-1.0, 1.0});
    EXPECT_FALSE(robot.explore->needs_goal());
    ASSERT_TRUE(robot.requests_goal_within(30.0));
    EXPECT_LT(std::hypot(robot.pose().x - 1.0, robot.pose().y - 1.0), 0.05);
    EXPECT_LT(std::abs(normalize_angle(robot.pose().yaw - std::numbers::pi)), 0.05);
    EXPECT_EQ(robot.explore->times_blocked(), 0);
    EXPECT_THAT(robot.explore->remarks(), testing::HasSubstr(" 4 m driven in "));
}

TEST(Explore, RequestsAnotherGoalIfThePathIsBlocked) {
    Exploring robot(walled({{0.0, -0.5, 0.4, 0.5}}));
    ASSERT_TRUE(robot.requests_goal_within(6.0));
    robot.explore->go({{-2.0, 0.0}, {1.0, 0.0}}, {2.0, 0.0});
    ASSERT_TRUE(robot.requests_goal_within(30.0));
    EXPECT_LT(robot.pose().x, -0.3);
    EXPECT_EQ(robot.explore->times_blocked(), 1);
    EXPECT_EQ(robot.driven.simulator().collisions(), 0U);
}

TEST(Explore, RecoversFromRepeatedBlocking) {
    Exploring robot(walled({{0.0, -0.5, 0.4, 0.5}}));
    ASSERT_TRUE(robot.requests_goal_within(6.0));
    Pose2 blocked_at;
    for (int n = 1; n <= 3; ++n) {
        blocked_at = robot.pose();
        robot.explore->go({{robot.pose().x, robot.pose().y}, {1.0, 0.0}}, {2.0, 0.0});
        ASSERT_TRUE(robot.requests_goal_within(30.0));
        EXPECT_EQ(robot.explore->times_blocked(), n);
    }
    EXPECT_GT(std::hypot(robot.pose().x - blocked_at.x, robot.pose().y - blocked_at.y), 0.3);
    EXPECT_EQ(robot.driven.simulator().collisions(), 0U);
}

TEST(Explore, WaitsForTheGivenTime) {
    Exploring robot(walled({}));
    ASSERT_TRUE(robot.requests_goal_within(6.0));
    const std::size_t scans = robot.driven.trajectory().size();
    robot.explore->wait(1.0);
    ASSERT_TRUE(robot.requests_goal_within(6.0));
    EXPECT_EQ(robot.driven.trajectory().size() - scans, 10U);
}

TEST(Explore, ReportsThatItIsDone) {
    Exploring robot(walled({}));
    ASSERT_TRUE(robot.requests_goal_within(6.0));
    EXPECT_EQ(robot.explore->remarks(), "exploring: 0 m driven in 4 s");
    robot.explore->finish();
    EXPECT_TRUE(robot.driven.is_done());
    EXPECT_EQ(robot.explore->remarks(),
              "explored: no frontier is reachable with a clearance of 0.22 m, 0 m driven in 4 s");
}

} // namespace
} // namespace scanloom::sim

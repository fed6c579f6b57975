#include "sim/drive/waypoints.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/drive/nearby_obstacles.hpp"
#include "tests/unit/sim/drive/driven.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace scanloom::sim {
namespace {

TEST(PotentialField, AttractsStraightToTheGoal) {
    EXPECT_LT(norm(potential_force({1.0, 1.0}, {4.0, 5.0}, {}) - Point2{0.6, 0.8}), 1e-12)
        << "the force is limited to 1";
    EXPECT_LT(norm(potential_force({1.0, 1.0}, {1.3, 1.4}, {}) - Point2{0.3, 0.4}), 1e-12)
        << "the force equals the distance";
}

TEST(PotentialField, RepulsionIsTheFirasFunctionOfTheDistance) {
    const Point2 here{0.0, 0.0};
    const double rho = 0.1;
    const double repulsion = 0.002 * (1.0 / rho - 1.0 / 0.5) / (rho * rho);
    const Point2 force = potential_force(here, here, std::vector{Point2{0.0, -(kBodyRadius + rho)}});
    EXPECT_NEAR(force.x, 0.0, 1e-12);
    EXPECT_NEAR(force.y, repulsion, 1e-12) << "the force points away from the obstacle";
    EXPECT_EQ(potential_force(here, here, std::vector{Point2{0.0, -(kBodyRadius + 0.51)}}), here)
        << "the obstacle is out of range";
}

TEST(PotentialField, UsesOnlyTheNearestObstaclePerDirection) {
    const std::vector<Point2> one{{0.4, 0.02}};
    std::vector<Point2> many;
    for (int n = 0; n < 50; ++n) many.push_back({0.4 + 0.001 * n, 0.02});
    EXPECT_EQ(potential_force({0, 0}, {1, 1}, one), potential_force({0, 0}, {1, 1}, many));
}

TEST(NearObstacles, AreKeptForThreeSecondsAndWithinOneMetre) {
    NearObstacles near;
    Senses senses;
    senses.obstacles = {{0.5, 0.0}, {0.51, 0.0}, {0.0, 1.1}};
    near.see(senses);
    EXPECT_EQ(near.places().size(), 1U) << "one place per square; the third obstacle is out of range";
    senses.obstacles = {};
    for (int n = 0; n < 59; ++n) near.see(senses);
    EXPECT_EQ(near.places().size(), 1U);
    near.see(senses);
    EXPECT_TRUE(near.places().empty());
    senses.obstacles = {{0.5, 0.0}};
    near.see(senses);
    near.see({{-0.6, 0.0, 0.0}, {}, {}});
    EXPECT_TRUE(near.places().empty()) << "the robot has driven away";
}

TEST(Waypoints, AreReachedInOrderWithAFullTurnAtEach) {
    const std::vector<Point2> goals{{1.5, 0.0}, {1.5, 1.5}, {-1.0, 1.0}};
    auto waypoints = std::make_unique<Waypoints>(goals);
    const Waypoints& going = *waypoints;
    Driven driven(walled({}), {-1, -1, 0}, std::move(waypoints));
    double last_yaw = 0.0;
    double turned = 0.0; // counted next to the first waypoint
    ASSERT_TRUE(driven.run(120.0, [&] {
        const Pose2& pose = driven.simulator().pose();
        if (going.reached() == 0 && norm(driven.trajectory().back() - goals[0]) < 0.1) {
            turned += std::abs(normalize_angle(pose.yaw - last_yaw));
        }
        last_yaw = pose.yaw;
    }));
    EXPECT_GT(turned, 2.0 * std::numbers::pi - 0.4);
    EXPECT_EQ(going.reached(), 3U);
    EXPECT_EQ(going.given_up(), 0U);
    EXPECT_EQ(going.remarks(), "waypoints: 3 of 3 reached");
    for (const Point2& goal : goals) EXPECT_LT(driven.nearest_to(goal), 0.1);
    EXPECT_EQ(driven.simulator().collisions(), 0U);
}

TEST(Waypoints, RobotDrivesAroundAnObstacle) {
    auto waypoints = std::make_unique<Waypoints>(std::vector<Point2>{{2.0, 0.0}});
    const Waypoints& going = *waypoints;
    Driven driven(walled({{-0.3, -0.9, 0.3, -0.05}}), {-2, 0, 0}, std::move(waypoints));
    EXPECT_TRUE(driven.run(60.0));
    EXPECT_EQ(going.reached(), 1U);
    EXPECT_EQ(driven.simulator().collisions(), 0U);
    EXPECT_GT(driven.clearance_min(), kBodyRadius + 0.05);
}

TEST(Waypoints, UnreachableWaypointIsGivenUpAndTheNextReached) {
    // a trap that is open to the west: the potential field holds the robot in it
    const std::vector<Box> trap{{0.0, -1.5, 0.2, 1.5}, {-1.5, 1.3, 0.0, 1.5}, {-1.5, -1.5, 0.0, -1.3}};
    auto waypoints = std::make_unique<Waypoints>(std::vector<Point2>{{1.5, 0.0}, {-2.2, 0.5}});
    const Waypoints& going = *waypoints;
    Driven driven(walled(trap), {-1, 0, 0}, std::move(waypoints));
    EXPECT_TRUE(driven.run(90.0));
    EXPECT_EQ(going.given_up(), 1U);
    EXPECT_EQ(going.reached(), 1U);
    EXPECT_EQ(going.remarks(), "waypoints: 1 of 2 reached, 1 abandoned: (1.5, 0) no path found");
    EXPECT_EQ(driven.simulator().collisions(), 0U);
}

TEST(Waypoints, GivenUpWaypointsAreReportedWithAFewReasons) {
    const std::vector<Point2> beyond{{9.0, 0.0}, {9.5, 0.0}, {9.0, 1.0}, {9.0, 2.0},
                                     {9.0, 3.0}, {9.0, 4.0}, {9.0, 5.0}};
    const auto explain = [](const Point2& place) { return place.x > 9.0 ? "far out" : ""; };
    auto waypoints = std::make_unique<Waypoints>(beyond, TourStart::kFirst, explain);
    const Waypoints& going = *waypoints;
    Driven driven(walled({}), {0, 0, 0}, std::move(waypoints));
    EXPECT_TRUE(driven.run(300.0));
    EXPECT_EQ(going.remarks(), "waypoints: 0 of 7 reached, 7 abandoned: (9, 0) no path found, (9.5, 0) far out, (9, 1) "
                               "no path found, (9, 2) no path found, (9, 3) no path found, and 2 more");
}

TEST(Waypoints, RoundTourStartsAtTheNearestVisibleWaypoint) {
    // (0, 1) is nearest to the start, but behind a wall
    const std::vector<Point2> tour{{0.0, 1.0}, {2.5, 2.0}, {1.8, -1.0}, {-2.5, -1.5}};
    auto waypoints = std::make_unique<Waypoints>(tour, TourStart::kNearest);
    const Waypoints& going = *waypoints;
    Driven driven(walled({{-1.5, 0.0, 1.5, 0.2}}), {0, -0.8, 2.0}, std::move(waypoints));
    driven.run(20.0);
    EXPECT_EQ(going.reached(), 1U);
    EXPECT_LT(driven.nearest_to(tour[2]), 0.1);
    EXPECT_TRUE(driven.run(200.0));
    EXPECT_EQ(going.reached() + going.given_up(), 4U);
}

TEST(Waypoints, IsDoneWithoutWaypoints) {
    Waypoints none({}, TourStart::kNearest);
    EXPECT_TRUE(none.is_done());
    EXPECT_EQ(none.step({}), Velocity{});
}

} // namespace
} // namespace scanloom::sim

#include "sim/world.hpp"

#include "sim/simulator.hpp"

#include <gtest/gtest.h>

namespace scanloom::sim {
namespace {

/// Returns a walker with a loop of 8 s.
Walker square() { return {.loop = {{0, 0}, {2, 0}, {2, 2}, {0, 2}}, .radius = 0.25, .pace = 1.0}; }

Point2 place_after(double seconds) {
    Walker walker = square();
    walk(walker, {100.0, 100.0}, seconds);
    return body_of(walker).centre;
}

TEST(Walker, FollowsItsLoopAtItsPace) {
    EXPECT_LT(norm(place_after(0.0) - Point2{0, 0}), 1e-9);
    EXPECT_LT(norm(place_after(1.5) - Point2{1.5, 0}), 1e-9);
    EXPECT_LT(norm(place_after(3.0) - Point2{2, 1}), 1e-9);
    EXPECT_LT(norm(place_after(7.0) - Point2{0, 1}), 1e-9);
    EXPECT_LT(norm(place_after(80.5) - Point2{0.5, 0}), 1e-9);
    EXPECT_EQ(body_of(square()).radius, 0.25);
}

TEST(Walker, WaitsForARobotAndContinuesWhenItLeaves) {
    Walker walker = square();
    for (int step = 0; step < 200; ++step) walk(walker, {1.5, 0.0}, 0.05);
    const double distance_waiting = norm(body_of(walker).centre - Point2{1.5, 0.0});
    EXPECT_GE(distance_waiting, kWalkerDistance - 1e-9);
    EXPECT_LT(distance_waiting, kWalkerDistance + 0.06);
    walk(walker, {100.0, 100.0}, 1.0);
    EXPECT_GT(body_of(walker).centre.x, 1.5);
}

TEST(Walker, MovesAwayFromATooNearRobot) {
    Walker walker = square();
    walker.walked = 1.0;
    for (int step = 0; step < 20; ++step) walk(walker, {0.5, 0.0}, 0.05);
    EXPECT_NEAR(body_of(walker).centre.x, 2.0, 1e-9);
}

TEST(Walker, ReducesTheClearance) {
    World world = make_room();
    world.walkers = {square()};
    world.walkers[0].loop = {{3.5, -3.0}, {3.5, -2.0}};
    EXPECT_EQ(clearance(world, {3.6, -3.0}), 0.0);
    EXPECT_NEAR(clearance(world, {3.0, -3.0}), 0.25, 1e-9);
    EXPECT_EQ(drive(world, {3.09, -3.0, 0.0}, {0.4, 0.1}), (Motion{0.0, 0.1 * kControlPeriod}));
    EXPECT_GT(drive(world, {3.05, -3.0, 0.0}, {0.4, 0.1}).forward, 0.0);
}

TEST(Walker, RoomLoopKeepsClearOfTheFurniture) {
    const World room = make_room();
    Walker walker = make_room_walker().walkers.at(0);
    for (int step = 0; step < 400; ++step) {
        EXPECT_GT(clearance(room, body_of(walker).centre), walker.radius + 0.1);
        walk(walker, {100.0, 100.0}, 0.05);
    }
}

} // namespace
} // namespace scanloom::sim

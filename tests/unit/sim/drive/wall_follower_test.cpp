#include "sim/drive/wall_follower.hpp"

#include "sim/drive/nearby_obstacles.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace scanloom::sim {
namespace {

constexpr double kWallTurnMax = std::numbers::pi / 4.0;

Velocity velocity_of(WallFollower& follower, const SectorRanges& nearest) { return follower.step({{}, nearest, {}}); }

Velocity first_step(const SectorRanges& nearest) {
    WallFollower follower;
    return velocity_of(follower, nearest);
}

TEST(WallFollower, DrivesForwardAndSlightlyRightInOpenSpace) {
    EXPECT_EQ(first_step({5, 5, 5}), (Velocity{0.4, -0.05}));
}

TEST(WallFollower, SteersTowardsSixtyCentimetresFromTheWall) {
    EXPECT_EQ(first_step({0.6, 5, 5}), (Velocity{0.4, 0.0}));
    EXPECT_LT(first_step({0.68, 5, 5}).turn, 0.0) << "too far from the wall: steer right";
    EXPECT_GT(first_step({0.5, 5, 5}).turn, 0.0) << "too near to the wall: steer left";
    EXPECT_NEAR(first_step({0.5, 5, 5}).turn, 0.05, 1e-12);
}

TEST(WallFollower, TurnsLeftInPlaceBeforeAWall) {
    EXPECT_EQ(first_step({0.6, 0.39, 5}), (Velocity{0.0, kWallTurnMax}));
    EXPECT_EQ(first_step({0.6, 0.41, 5}).forward, 0.4);
}

TEST(WallFollower, BacksOffFromNearObstacles) {
    EXPECT_EQ(first_step({5, 5, 0.34}).forward, -0.2);
    EXPECT_EQ(first_step({0.34, 5, 5}).forward, -0.2);
}

TEST(WallFollower, StopsVeryNearAndRecoversAfterThirtyStops) {
    WallFollower follower;
    const SectorRanges blocked{0.2, 5, 5};
    for (int i = 0; i < 31; ++i) EXPECT_EQ(velocity_of(follower, blocked), (Velocity{0.0, 0.0})) << i;
    for (int i = 0; i < 40; ++i) EXPECT_EQ(velocity_of(follower, blocked), (Velocity{-0.08, -0.6 * kWallTurnMax})) << i;
    EXPECT_EQ(velocity_of(follower, blocked), (Velocity{0.0, 0.0})) << "recovery ends after 40 steps";
}

TEST(WallFollower, RecoveryEndsEarlyInFreeSpace) {
    WallFollower follower;
    for (int i = 0; i < 31; ++i) static_cast<void>(velocity_of(follower, {0.2, 5, 5}));
    EXPECT_EQ(velocity_of(follower, {0.2, 5, 5}).forward, -0.08);
    EXPECT_EQ(velocity_of(follower, {0.45, 5, 5}).forward, -0.08);
    EXPECT_EQ(velocity_of(follower, {0.45, 5, 5}).forward, 0.4);
}

TEST(WallFollower, OnlyConsecutiveStopsCount) {
    WallFollower follower;
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < 30; ++i) EXPECT_EQ(velocity_of(follower, {0.2, 5, 5}), (Velocity{0.0, 0.0}));
        EXPECT_EQ(velocity_of(follower, {5, 5, 5}).forward, 0.4);
    }
}

TEST(WallFollower, TurnsAroundTheEndOfAWall) {
    WallFollower follower;
    EXPECT_EQ(velocity_of(follower, {0.65, 5, 5}).forward, 0.4);
    for (const double right : {5.0, 0.71, 0.65}) {
        const Velocity around = velocity_of(follower, {right, 5, 5});
        EXPECT_EQ(around.forward, 0.3) << right;
        EXPECT_NEAR(around.forward / around.turn, -0.55, 1e-12)
            << "the robot drives a circle around the object on its right";
    }
    EXPECT_EQ(velocity_of(follower, {0.59, 5, 5}).forward, 0.4);
    EXPECT_EQ(velocity_of(follower, {0.69, 5, 5}).forward, 0.4) << "a followed wall counts up to 0.7 m";
}

TEST(WallFollower, SearchesIfNoWallFollowsACorner) {
    WallFollower follower;
    static_cast<void>(velocity_of(follower, {0.6, 5, 5}));
    for (int i = 0; i < 180; ++i) EXPECT_EQ(velocity_of(follower, {5, 5, 5}).forward, 0.3) << i;
    EXPECT_EQ(velocity_of(follower, {5, 5, 5}), (Velocity{0.4, -0.05}));
}

TEST(WallFollower, LeavesAnObjectAfterSurroundingIt) {
    WallFollower follower;
    double turned = 0.0;
    for (int step = 0; turned > -2.5 * std::numbers::pi; ++step) {
        ASSERT_LT(step, 400);
        const bool is_side = step % 60 == 0; // a table: each corner is followed by a side
        turned += velocity_of(follower, {is_side ? 0.59 : 5.0, 5, 5}).turn / 20.0;
    }
    for (const double right : {0.6, 0.5, 5.0})
        EXPECT_EQ(velocity_of(follower, {right, 5, 5}), (Velocity{0.4, 0.0})) << right;
    EXPECT_EQ(velocity_of(follower, {0.6, 0.39, 5}), (Velocity{0.0, kWallTurnMax})) << "another wall is ahead";
    EXPECT_LT(velocity_of(follower, {0.65, 5, 5}).turn, 0.0);
    EXPECT_GT(velocity_of(follower, {0.55, 5, 5}).turn, 0.0);
}

TEST(Sectors, UseEachValidBeamInItsSector) {
    Sensor laser;
    laser.angles = UniformAngles{-180.0 * kDegree, 30.0 * kDegree, 12};
    Scan scan; //     -180 -150 -120 -90  -60   -30   0   30        60  90   120  150
    scan.ranges = {100, 100, 100, 900, 800, 2000, 1500, kNoReturn, 0, 3000, 100, 100};
    const SectorRanges nearest = sector_ranges(scan, laser);
    EXPECT_DOUBLE_EQ(nearest.right, 0.8);
    EXPECT_DOUBLE_EQ(nearest.front, 1.5);
    EXPECT_DOUBLE_EQ(nearest.left, 3.0);
}

TEST(Obstacles, AreTheEndsOfReturningBeams) {
    Sensor laser;
    laser.mount = {0.5, 0.0, 0.0};
    laser.angles = UniformAngles{0.0, std::numbers::pi / 2.0, 4};
    Scan scan;
    scan.pose = {1.0, 2.0, std::numbers::pi / 2.0};
    scan.ranges = {1000, 2000, kNoReturn, 0};
    const auto obstacles = obstacles_of(scan, laser);
    ASSERT_EQ(obstacles.size(), 2U);
    EXPECT_LT(norm(obstacles[0] - Point2{1.0, 3.5}), 1e-9);
    EXPECT_LT(norm(obstacles[1] - Point2{-1.0, 2.5}), 1e-9);
}

} // namespace
} // namespace scanloom::sim

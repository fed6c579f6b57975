#include "sim/drive/path_follower.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/drive/nearby_obstacles.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scanloom::sim {
namespace {

/// Returns the senses of a robot at the origin with heading 0, with three beams that end at each place.
Senses senses_of(const std::vector<Point2>& places) {
    Senses senses;
    for (const Point2& place : places) senses.obstacles.insert(senses.obstacles.end(), 3, place);
    return senses;
}

TEST(FreeAhead, EndsBeforeTheBodyGetsTooNear) {
    EXPECT_EQ(free_ahead(senses_of({}), 0.0), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(free_ahead(senses_of({{1.0, 0.0}}), 0.0), 1.0 - kKeptClear, 1e-12);
    EXPECT_NEAR(free_ahead(senses_of({{2.0, 0.0}, {1.0, 0.1}}), 0.0), 1.0 - std::sqrt(kKeptClear * kKeptClear - 0.01),
                1e-12);
}

TEST(FreeAhead, IsComputedForAnyDirection) {
    const Senses senses = senses_of({{0.0, 1.0}});
    EXPECT_EQ(free_ahead(senses, 0.0), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(free_ahead(senses, kPi / 2.0), 1.0 - kKeptClear, 1e-12);
}

TEST(FreeAhead, IgnoresObstaclesAtTheSideOrBehind) {
    EXPECT_EQ(free_ahead(senses_of({{1.0, kKeptClear + 0.001}, {-0.16, 0.0}, {0.0, 0.16}}), 0.0),
              std::numeric_limits<double>::infinity());
}

TEST(FreeAhead, VeryNearObstaclesLimitOnlyContact) {
    EXPECT_EQ(free_ahead(senses_of({{0.16, 0.0}}), 0.0), 0.16 - (kBodyRadius + 0.005));
    EXPECT_EQ(free_ahead(senses_of({{0.04, 0.158}}), 0.0), std::numeric_limits<double>::infinity())
        << "the robot passes next to the obstacle";
}

TEST(FreeAhead, IgnoresTwoBeams) {
    Senses senses;
    senses.obstacles = {{0.5, 0.0}, {0.5, 0.01}};
    EXPECT_EQ(free_ahead(senses, 0.0), std::numeric_limits<double>::infinity());
    senses.obstacles.push_back({0.6, 0.0});
    EXPECT_NEAR(free_ahead(senses, 0.0), 0.6 - kKeptClear, 1e-12);
}

TEST(Steering, SpeedDecreasesWithTheFreeDistance) {
    EXPECT_EQ(safe_speed(senses_of({}), 0.0), kForwardMax);
    EXPECT_NEAR(safe_speed(senses_of({{kKeptClear + 0.1, 0.0}}), 0.0), 0.25, 1e-9);
    EXPECT_EQ(drive_towards(senses_of({{0.16, 0.0}}), 0.0, 0.7).forward, safe_speed(senses_of({{0.16, 0.0}}), 0.0));
}

TEST(Steering, TurnsInPlaceForLargeHeadingErrors) {
    const Velocity turning = drive_towards({}, 1.5, 0.7);
    EXPECT_EQ(turning.forward, 0.0);
    EXPECT_GT(turning.turn, 0.0);
    const Velocity bow = drive_towards({}, -0.2, 0.7);
    EXPECT_GT(bow.forward, 0.1);
    EXPECT_LT(bow.forward, 0.7);
    EXPECT_LT(bow.turn, 0.0);
    EXPECT_EQ(drive_towards({}, 0.0, 0.7), (Velocity{0.7, 0.0}));
}

TEST(Steering, TurnsAlongTheShorterArc) {
    EXPECT_LT(turn_to({0, 0, -3.0}, 3.0).turn, 0.0);
    EXPECT_TRUE(is_heading({0, 0, -kPi + 0.01}, kPi - 0.01));
}

TEST(FullTurn, EndsAtTheInitialHeading) {
    FullTurn turn;
    Pose2 pose{1.0, 2.0, 2.5};
    int steps = 0;
    while (!turn.is_done()) {
        ASSERT_LT(++steps, 200);
        const Velocity velocity = turn.step(pose);
        EXPECT_EQ(velocity.forward, 0.0);
        const double slip = steps < 10 ? 0.7 : 1.0; // the measured rotation counts, not the commanded one
        pose.yaw = normalize_angle(pose.yaw + slip * velocity.turn * kControlPeriod);
    }
    EXPECT_NEAR(pose.yaw, 2.5, 1e-6);
    EXPECT_GT(steps, 60);
}

} // namespace
} // namespace scanloom::sim

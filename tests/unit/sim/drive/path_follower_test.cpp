#include "sim/drive/path_follower.hpp"

#include "sim/drive/behaviour.hpp"
#include "sim/drive/nearby_obstacles.hpp"
#include "tests/unit/sim/drive/driven.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace scanloom::sim {
namespace {

/// Follows one path and records the longest time for which it was blocked.
class Follow final : public Behaviour {
public:
    explicit Follow(std::vector<Point2> path) : follower_(std::move(path)) {}
    Velocity step(const Senses& senses) override {
        const Velocity velocity = follower_.step(senses);
        blocked_max = std::max(blocked_max, follower_.blocked_steps());
        return velocity;
    }
    [[nodiscard]] bool is_done() const override { return follower_.has_arrived(); }

    int blocked_max = 0;

private:
    PathFollower follower_;
};

double distance_to_path(const Point2& point, const std::vector<Point2>& path) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n + 1 < path.size(); ++n) {
        nearest = std::min(nearest, distance(Segment{path[n].x, path[n].y, path[n + 1].x, path[n + 1].y}, point));
    }
    return nearest;
}

TEST(PathFollower, StaysNearThePathAtEveryCorner) {
    const std::vector<Point2> path{{-2, -2}, {2, -2}, {2, 0}, {-1, 0}, {0.5, 2}, {0.4, -1.5}, {0.3, -1.4}};
    Driven driven(walled({}), {-2, -2, 1.0}, std::make_unique<Follow>(path));
    ASSERT_TRUE(driven.run(120.0));
    for (const Point2& place : driven.trajectory()) EXPECT_LT(distance_to_path(place, path), 0.05);
    for (const Point2& corner : path) EXPECT_LT(driven.nearest_to(corner), 0.06);
    EXPECT_LT(norm(driven.trajectory().back() - path.back()), 0.05);
}

TEST(PathFollower, FollowsThePathCloselyAroundACorner) {
    const World world = walled({{-0.5, -3.0, 0.5, 1.0}});
    const std::vector<Point2> path{{-1.5, -2}, {-0.7, 1.2}, {0.7, 1.2}, {1.5, -2}};
    Driven driven(world, {-1.5, -2, 0.0}, std::make_unique<Follow>(path));
    ASSERT_TRUE(driven.run(60.0));
    EXPECT_EQ(driven.simulator().collisions(), 0U);
    EXPECT_GT(driven.clearance_min(), kKeptClear);
}

TEST(PathFollower, ArrivesNextToAWall) {
    Driven driven(walled({}), {0, 0, 0.0}, std::make_unique<Follow>(std::vector<Point2>{{0, 0}, {2.78, 0}}));
    EXPECT_TRUE(driven.run(30.0));
    EXPECT_GT(driven.trajectory().back().x, 2.65);
}

TEST(PathFollower, ArrivesIfThePathEndsTooNearToAWall) {
    Driven driven(walled({}), {0, 0, 0.0}, std::make_unique<Follow>(std::vector<Point2>{{0, 0}, {2.9, 0}}));
    EXPECT_TRUE(driven.run(30.0));
    EXPECT_NEAR(driven.trajectory().back().x, 3.0 - kKeptClear, 0.03);
    EXPECT_EQ(driven.simulator().collisions(), 0U);
}

TEST(PathFollower, SlowsDownBeforeASharpCorner) {
    PathFollower sharp({{0, 0}, {1, 0}, {1, 1}});
    PathFollower gentle({{0, 0}, {1, 0}, {2, 0.1}});
    Senses senses;
    senses.pose.x = 0.9;
    EXPECT_LT(sharp.step(senses).forward, 0.35);
    EXPECT_GT(gentle.step(senses).forward, 0.6) << "a gentle corner must not stop the robot";
}

TEST(PathFollower, StopsBeforeAnObstacleAndReportsIt) {
    auto follow = std::make_unique<Follow>(std::vector<Point2>{{-2, 0}, {2, 0}});
    const Follow& followed = *follow;
    Driven driven(walled({{0.5, -0.3, 1.0, 0.3}}), {-2, 0, 0.0}, std::move(follow));
    EXPECT_FALSE(driven.run(30.0));
    EXPECT_EQ(driven.simulator().collisions(), 0U);
    EXPECT_NEAR(driven.trajectory().back().x, 0.5 - kKeptClear - 0.2, 0.03);
    EXPECT_GT(followed.blocked_max, 300);
}

TEST(PathFollower, ContinuesWhenThePathIsFreeAgain) {
    PathFollower follower({{0, 0}, {2, 0}});
    Senses senses;
    senses.obstacles.assign(5, {0.3, 0.0});
    for (int n = 1; n <= 10; ++n) {
        EXPECT_EQ(follower.step(senses).forward, 0.0);
        EXPECT_EQ(follower.blocked_steps(), n);
    }
    senses.obstacles.clear();
    EXPECT_GT(follower.step(senses).forward, 0.5);
    EXPECT_EQ(follower.blocked_steps(), 0);
}

TEST(PathFollower, HasArrivedWithoutAPath) {
    PathFollower follower;
    EXPECT_TRUE(follower.has_arrived());
    EXPECT_EQ(follower.step({}), Velocity{});
    EXPECT_TRUE(PathFollower({{1.0, 1.0}}).has_arrived());
}

TEST(PathFollower, ReturnsTheRemainingPathLength) {
    EXPECT_NEAR(PathFollower({{0, 0}, {2, 0}, {2, 1}}).left({0.5, 0.0}), 2.5, 1e-12);
    EXPECT_EQ(PathFollower().left({0.5, 0.0}), 0.0);
}

} // namespace
} // namespace scanloom::sim

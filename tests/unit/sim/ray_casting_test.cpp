#include "sim/ray_casting.hpp"

#include "sim/noise.hpp"
#include "sim/world.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace scanloom::sim {
namespace {

TEST(RayCasting, DistanceToAWallMatchesGeometry) {
    const std::vector<Segment> wall = {{2.0, -1.0, 2.0, 1.0}};
    EXPECT_NEAR(cast_ray(wall, {0, 0}, 0.0), 2.0, 1e-12);
    EXPECT_NEAR(cast_ray(wall, {0, 0}, std::atan2(0.5, 2.0)), std::hypot(2.0, 0.5), 1e-12);
    EXPECT_NEAR(cast_ray(wall, {0.5, 0}, 0.0), 1.5, 1e-12);
    EXPECT_EQ(cast_ray(wall, {0, 0}, kPi), std::numeric_limits<double>::infinity()) << "the wall is behind the ray";
    EXPECT_EQ(cast_ray(wall, {0, 0}, std::atan2(1.1, 2.0)), std::numeric_limits<double>::infinity())
        << "the ray misses the wall";
}

TEST(RayCasting, DistanceToADiscMatchesGeometry) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const Disc disc{{3.0, 4.0}, 0.5};
    const double ahead = std::atan2(4.0, 3.0);
    EXPECT_NEAR(cast_ray(disc, {0, 0}, ahead), 4.5, 1e-12);
    EXPECT_NEAR(cast_ray(disc, {0, 0}, ahead + std::asin(0.1) * 0.999999), std::sqrt(25.0 - 0.25), 2e-3) << "a tangent";
    EXPECT_EQ(cast_ray(disc, {0, 0}, ahead - 0.1003), kNone) << "the ray misses the disc";
    EXPECT_EQ(cast_ray(disc, {0, 0}, ahead + kPi), kNone) << "the disc is behind the ray";
    EXPECT_NEAR(cast_ray(disc, {3.0, 4.0}, 1.0), 0.5, 1e-12) << "the ray starts inside the disc";
    Random random(5);
    for (int i = 0; i < 1000; ++i) {
        const double yaw = ahead + random.uniform(-0.1, 0.1);
        const Point2 hit = cast_ray(disc, {0, 0}, yaw) * Point2{std::cos(yaw), std::sin(yaw)};
        EXPECT_NEAR(norm(hit - disc.centre), disc.radius, 1e-9);
        EXPECT_LT(norm(hit), 5.0) << "the ray hits the near side";
    }
}

TEST(RayCasting, ClosedOutlineHasNoGapsAtCorners) {
    const std::vector<Segment> triangle = {{0.1, 0.1, 3.3, 0.7}, {3.3, 0.7, 1.9, 2.3}, {1.9, 2.3, 0.1, 0.1}};
    Random random(12);
    for (int i = 0; i < 100'000; ++i) {
        // a point inside the triangle, between two of its sides
        const double u = random.uniform(0.05, 0.9);
        const double v = random.uniform(0.05, 0.95 - u);
        const Point2 origin{0.1 + u * 3.2 + v * 1.8, 0.1 + u * 0.6 + v * 2.2};
        const Segment& corner = triangle[random.index(3)];
        const double yaw = std::atan2(corner.ay - origin.y, corner.ax - origin.x);
        ASSERT_LT(cast_ray(triangle, origin, yaw), 4.0) << "the ray passes through the corner at " << corner.ax;
    }
}

/// Finds the nearest solid by small steps along the ray. It is slow, but shares no formula with the implementation.
double march(const World& world, const Point2& origin, double yaw, double step) {
    const double step_x = step * std::cos(yaw);
    const double step_y = step * std::sin(yaw);
    for (double length = 0.0, x = origin.x, y = origin.y; length < 75.0; length += step, x += step_x, y += step_y) {
        for (const Box& box : world.solids) {
            if (x >= box.x_min && x <= box.x_max && y >= box.y_min && y <= box.y_max) return length;
        }
    }
    return std::numeric_limits<double>::infinity();
}

class Worlds : public testing::TestWithParam<const char*> {
protected:
    World world_ = *find_world(GetParam());
    Random random_{9};

    Point2 free_place() {
        for (;;) {
            const Box& floor = world_.floors[random_.index(world_.floors.size())];
            const Point2 place{random_.uniform(floor.x_min, floor.x_max), random_.uniform(floor.y_min, floor.y_max)};
            if (clearance(world_, place) > 0.01) return place;
        }
    }
};

TEST_P(Worlds, RaysMatchMarchingThroughTheSolids) {
    constexpr double kStep = 0.002;
    for (int i = 0; i < 50; ++i) {
        const Point2 origin = free_place();
        const double yaw = random_.uniform(-kPi, kPi);
        const double exact = cast_ray(world_.outlines, origin, yaw);
        const double marched = march(world_, origin, yaw, kStep);
        // the march may step over the tip of a corner, so only its result may be larger
        EXPECT_LE(exact, marched + 1e-9);
        const Point2 hit = origin + (exact + 1e-7) * Point2{std::cos(yaw), std::sin(yaw)};
        EXPECT_LT(clearance(world_, hit), 1e-6) << "a ray must end at a solid";
    }
}

TEST_P(Worlds, NoRayLeavesTheWorld) {
    for (int i = 0; i < 20; ++i) {
        const Point2 origin = free_place();
        for (int beam = 0; beam < 3600; ++beam) {
            ASSERT_LT(cast_ray(world_.outlines, origin, beam * kPi / 1800.0), 73.0);
        }
        for (const Segment& segment : world_.outlines) {
            const double to_corner = std::atan2(segment.ay - origin.y, segment.ax - origin.x);
            ASSERT_LT(cast_ray(world_.outlines, origin, to_corner), 73.0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, Worlds, testing::Values("room", "office", "hall"));

} // namespace
} // namespace scanloom::sim

#include "sim/obstacles.hpp"

#include "sim/noise.hpp"
#include "sim/ray_casting.hpp"
#include "tests/support/angles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace scanloom::sim {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Returns segments of many lengths and directions, some of them axis-aligned or connected.
std::vector<Segment> random_segments(Random& random, std::size_t count) {
    const double extent = random.uniform(1.0, 100.0);
    const double x = random.uniform(-1000.0, 1000.0);
    const double y = random.uniform(-1000.0, 1000.0);
    std::vector<Segment> segments;
    while (segments.size() < count) {
        const double length = extent * std::pow(random.uniform(0.0, 1.0), 3.0);
        const Point2 a{x + random.uniform(0.0, extent), y + random.uniform(0.0, extent)};
        const Point2 b{a.x + random.uniform(-length, length), a.y + random.uniform(-length, length)};
        switch (random.index(4)) {
        case 0: segments.push_back({a.x, a.y, b.x, a.y}); break;
        case 1: segments.push_back({a.x, a.y, a.x, b.y}); break;
        case 2:
            if (!segments.empty()) segments.push_back({segments.back().bx, segments.back().by, b.x, b.y});
            break;
        default: segments.push_back({a.x, a.y, b.x, b.y}); break;
        }
    }
    return segments;
}

/// Returns a place near the segments, on one of them, or at an end.
Point2 random_place(Random& random, const std::vector<Segment>& segments) {
    const Segment& near = segments[random.index(segments.size())];
    const double reach = std::pow(10.0, random.uniform(-6.0, 2.5));
    switch (random.index(4)) {
    case 0: return {near.ax, near.ay};
    case 1: return {(near.ax + near.bx) / 2.0, (near.ay + near.by) / 2.0};
    default: return {near.ax + random.uniform(-reach, reach), near.by + random.uniform(-reach, reach)};
    }
}

double random_yaw(Random& random, const Point2& origin, const std::vector<Segment>& segments) {
    const Segment& target = segments[random.index(segments.size())];
    switch (random.index(3)) {
    case 0: return kPi / 2.0 * static_cast<double>(random.index(4)); // axis-aligned
    case 1: return std::atan2(target.ay - origin.y, target.ax - origin.x);
    default: return random.uniform(-kPi, kPi);
    }
}

TEST(Obstacles, RaysMatchBruteForceOverAllSegments) {
    Random random(11);
    std::size_t hits = 0;
    for (const std::size_t count : {1U, 2U, 3U, 10U, 100U, 1000U}) {
        for (int world = 0; world < 20; ++world) {
            const auto segments = random_segments(random, count);
            const Obstacles obstacles(segments, {});
            for (int i = 0; i < 300; ++i) {
                const Point2 origin = random_place(random, segments);
                const double yaw = random_yaw(random, origin, segments);
                const double wanted = cast_ray(segments, origin, yaw);
                ASSERT_EQ(obstacles.cast_ray(origin, yaw, kFar), wanted) << count << ' ' << world << ' ' << i;
                hits += wanted < kFar;
                const double range_max = std::pow(10.0, random.uniform(-2.0, 2.0));
                const double within = obstacles.cast_ray(origin, yaw, range_max);
                if (wanted <= range_max) {
                    ASSERT_EQ(within, wanted);
                } else {
                    ASSERT_GT(within, range_max);
                }
            }
        }
    }
    EXPECT_GT(hits, 15'000U);
}

TEST(Obstacles, DistancesMatchBruteForceOverAllSegments) {
    Random random(12);
    for (const std::size_t count : {1U, 2U, 10U, 300U}) {
        for (int world = 0; world < 20; ++world) {
            const auto segments = random_segments(random, count);
            const Obstacles obstacles(segments, {});
            for (int i = 0; i < 200; ++i) {
                const Point2 place = random_place(random, segments);
                double wanted = kFar;
                for (const Segment& segment : segments) wanted = std::min(wanted, distance(segment, place));
                ASSERT_EQ(obstacles.distance(place), wanted);
            }
        }
    }
}

TEST(Obstacles, ContainMatchesBruteForceOverAllSolids) {
    Random random(13);
    for (int world = 0; world < 50; ++world) {
        std::vector<Box> solids;
        for (std::size_t i = 0; i <= random.index(200); ++i) {
            const double x = random.uniform(-20.0, 20.0);
            const double y = random.uniform(-20.0, 20.0);
            solids.push_back({x, y, x + random.uniform(0.0, 3.0), y + random.uniform(0.0, 3.0)});
        }
        const Obstacles obstacles({}, solids);
        for (int i = 0; i < 500; ++i) {
            const Box& near = solids[random.index(solids.size())];
            const Point2 place = i % 5 == 0 ? Point2{near.x_max, near.y_min}
                                            : Point2{random.uniform(-25.0, 25.0), random.uniform(-25.0, 25.0)};
            const bool wanted = std::ranges::any_of(solids, [&](const Box& box) { return box.contains(place); });
            ASSERT_EQ(obstacles.contain(place), wanted);
        }
    }
}

TEST(Obstacles, EmptyObstaclesStopNoRay) {
    const Obstacles none;
    EXPECT_EQ(none.cast_ray({1.0, 2.0}, 0.3, kFar), kFar);
    EXPECT_EQ(none.distance({1.0, 2.0}), kFar);
    EXPECT_FALSE(none.contain({1.0, 2.0}));
}

} // namespace
} // namespace scanloom::sim

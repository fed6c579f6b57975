#include "core/scan_matching/point_map.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>

namespace scanloom::scan_matching {
namespace {

using testing_support::uniform;

std::vector<SurfacePoint> random_points(std::mt19937& random, std::size_t count) {
    std::vector<SurfacePoint> points;
    for (std::size_t n = 0; n < count; ++n) {
        const auto [s, c] = sin_cos(uniform(random, -3.0, 3.0));
        const bool has_normal = random() % 4 != 0;
        points.push_back({float(uniform(random, -3.0, 3.0)), float(uniform(random, -2.0, 2.0)),
                          has_normal ? float(c) : 0.0F, has_normal ? float(s) : 0.0F});
    }
    return points;
}

/// Returns the nearest point by comparing with all.
float nearest_by_brute_force(std::span<const SurfacePoint> points, const SurfacePoint& point, float distance) {
    float nearest = distance * distance;
    for (const SurfacePoint& other : points) {
        const bool both = other.has_normal() && point.has_normal();
        if (both && other.normal_x * point.normal_x + other.normal_y * point.normal_y < 0.5F) continue;
        const float dx = other.x - point.x;
        const float dy = other.y - point.y;
        nearest = std::min(nearest, dx * dx + dy * dy);
    }
    return nearest;
}

TEST(PointMap, NearestPointIsThatOfBruteForce) {
    std::mt19937 random(1);
    for (int round = 0; round < 200; ++round) {
        const auto points = random_points(random, random() % 400);
        const View view{Transform2(), points};
        const PointMap map(std::span(&view, 1));
        for (const auto& point : random_points(random, 50)) {
            const auto distance = static_cast<float>(uniform(random, 0.05, 1.0));
            const auto found = map.nearest(point, distance);
            const float expected = nearest_by_brute_force(map.points(), point, distance);
            ASSERT_EQ(found.squared_distance, expected);
            ASSERT_EQ(found.point != nullptr, expected < distance * distance);
        }
    }
}

TEST(PointMap, ASquareKeepsThePointOfTheFirstView) {
    std::mt19937 random(2);
    const auto older = random_points(random, 3000);
    const auto newer = random_points(random, 3000);
    const std::vector<View> views{{transform_of({1.0, 2.0, 0.5}), newer}, {transform_of({0.0, 0.0, -0.2}), older}};
    const PointMap map(views);
    const auto square_of = [](const SurfacePoint& point) {
        return std::pair(std::floor(point.x / PointMap::kThinning), std::floor(point.y / PointMap::kThinning));
    };
    std::set<std::pair<double, double>> squares;
    for (const auto& point : map.points()) EXPECT_TRUE(squares.insert(square_of(point)).second);
    std::set<std::pair<double, double>> taken;
    for (const View& view : views) {
        for (const auto& point : view.points) {
            const auto moved = transform(view.T_map_robot, point);
            if (!taken.insert(square_of(moved)).second) continue;
            EXPECT_EQ(map.nearest(moved, 0.01F).squared_distance, 0.0F);
        }
    }
    EXPECT_EQ(taken, squares);
}

TEST(PointMap, AnEmptyMapHasNoNeighbors) {
    EXPECT_EQ(PointMap().nearest({0.0F, 0.0F}, 10.0F).point, nullptr);
    const View view{Transform2(), {}};
    EXPECT_EQ(PointMap(std::span(&view, 1)).nearest({0.0F, 0.0F}, 10.0F).point, nullptr);
}

} // namespace
} // namespace scanloom::scan_matching

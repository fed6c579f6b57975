#include "core/landmarks/point_index.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;

/// Returns all points ordered by distance, equally near ones by index.
std::vector<Neighbor> all_by_distance(const std::vector<Point2>& points, const Point2& place) {
    std::vector<std::pair<double, std::size_t>> squares;
    for (std::size_t n = 0; n < points.size(); ++n) {
        const double dx = points[n].x - place.x;
        const double dy = points[n].y - place.y;
        squares.emplace_back(dx * dx + dy * dy, n);
    }
    std::ranges::sort(squares);
    std::vector<Neighbor> neighbors;
    for (const auto& [squared, index] : squares) neighbors.push_back({index, std::sqrt(squared)});
    return neighbors;
}

TEST(PointTree, MatchesBruteForceOverAllPoints) {
    std::mt19937 random(1);
    for (int round = 0; round < 3000; ++round) {
        const auto points = random_points(random, 1 + random() % 120);
        const PointTree tree(points);
        ASSERT_EQ(tree.size(), points.size());
        const Point2 place = round % 2 == 0 ? points[random() % points.size()]
                                            : Point2{uniform(random, -4.0, 4.0), uniform(random, -4.0, 4.0)};
        const auto all = all_by_distance(points, place);
        ASSERT_EQ(tree.nearest(place), all.front());
        const std::size_t count = random() % (points.size() + 5);
        const auto nearest = tree.nearest(place, count);
        ASSERT_THAT(nearest, testing::ElementsAreArray(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(
                                                                                      std::min(count, points.size()))));
        const double radius = 0.25 * static_cast<double>(random() % 8);
        const auto end = std::ranges::find_if(
            all, [&](const Neighbor& one) { return squared_norm(points[one.index] - place) > radius * radius; });
        ASSERT_THAT(tree.within(place, radius), testing::ElementsAreArray(all.begin(), end)) << "radius " << radius;
        ASSERT_EQ(tree.nearest_within(place, radius), end == all.begin() ? std::nullopt : std::optional(all.front()));
    }
}

TEST(PointTree, ReturnsEqualPointsInIndexOrder) {
    std::vector<Point2> points(5000, Point2{1.0, 2.0});
    points[10] = {3.0, 2.0};
    const PointTree tree(points);
    EXPECT_EQ(tree.nearest({1.0, 2.0}), (Neighbor{0, 0.0}));
    EXPECT_THAT(tree.nearest({1.0, 2.0}, 3),
                testing::ElementsAre(Neighbor{0, 0.0}, Neighbor{1, 0.0}, Neighbor{2, 0.0}));
    EXPECT_THAT(tree.within({3.0, 2.0}, 1.0), testing::ElementsAre(Neighbor{10, 0.0}));
    EXPECT_THAT(tree.within({1.0, 2.0}, 0.0), testing::SizeIs(4999));
}

TEST(PointTree, IsEmptyWithoutPoints) {
    const PointTree tree({});
    EXPECT_EQ(tree.size(), 0U);
    EXPECT_EQ(tree.nearest({1.0, 2.0}), std::nullopt);
    EXPECT_EQ(tree.nearest_within({1.0, 2.0}, 1.0), std::nullopt);
    EXPECT_THAT(tree.nearest({1.0, 2.0}, 3), testing::IsEmpty());
    EXPECT_THAT(tree.within({1.0, 2.0}, std::numeric_limits<double>::infinity()), testing::IsEmpty());
}

TEST(PointTree, InfiniteRadiusContainsAllPoints) {
    const std::vector<Point2> points = {{1e7, -1e7}, {0.0, 0.0}, {-1e7, 1e7}};
    EXPECT_THAT(PointTree(points).within({0.0, 0.0}, std::numeric_limits<double>::infinity()), testing::SizeIs(3));
}

TEST(PointTree, DistinguishesPointsOfEveryScale) {
    std::vector<Point2> points;
    for (int n = 0; n < 300; ++n) points.push_back({std::ldexp(1.0, 20 - n), 0.0});
    const PointTree tree(points);
    for (std::size_t n = 0; n < points.size(); ++n) ASSERT_EQ(tree.nearest(points[n])->index, n);
}

TEST(PointTree, MoveTransfersThePoints) {
    PointTree tree(std::vector<Point2>{{1.0, 1.0}});
    tree = PointTree(std::vector<Point2>{{5.0, 5.0}, {6.0, 6.0}});
    const PointTree moved = std::move(tree);
    EXPECT_EQ(moved.nearest({6.0, 7.0}), (Neighbor{1, 1.0}));
}

} // namespace
} // namespace scanloom::landmarks

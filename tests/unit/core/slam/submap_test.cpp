#include "core/slam/submap.hpp"
#include "tests/support/uniform.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <random>
#include <set>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::transform_of;
using testing_support::uniform;

/// Returns a scan of random points around the robot, by which it can be recognised.
std::shared_ptr<const ScanPoints> random_points(std::mt19937& random) {
    ScanPoints scan;
    for (int n = 0; n < 20; ++n) {
        const auto coordinate = [&] { return static_cast<float>(uniform(random, -5.0, 5.0)); };
        scan.points.push_back({.x = coordinate(), .y = coordinate()});
    }
    return std::make_shared<const ScanPoints>(std::move(scan));
}

Transform2 random_step(std::mt19937& random) {
    return transform_of({uniform(random, 0.5, 1.0), uniform(random, -0.2, 0.2), uniform(random, -0.4, 0.4)});
}

/// Two robots whose keyframes alternate.
KeyframeGraph graph_of_two(std::mt19937& random, std::size_t keyframes_of_each) {
    KeyframeGraph graph;
    for (std::size_t n = 0; n < keyframes_of_each; ++n) {
        for (std::size_t fragment = 0; fragment < 2; ++fragment) {
            if (n == 0) graph.begin_fragment(fragment, random_points(random), random_step(random), true);
            if (n > 0) graph.add(fragment, random_points(random), random_step(random));
        }
    }
    return graph;
}

TEST(Submaps, EachHasTwelveKeyframesOfAFragmentAroundItsAnchor) {
    std::mt19937 random(1);
    const KeyframeGraph graph = graph_of_two(random, 40);
    Submaps submaps;
    for (const std::size_t fragment : {0U, 1U}) submaps.extend(graph, fragment);
    ASSERT_EQ(submaps.size(), 12U) << "that begin at 0, 5 ... 25 of each fragment";
    for (std::size_t n = 0; n < submaps.size(); ++n) {
        const Submap& submap = submaps[n];
        const std::size_t first = n % 6 * kSubmapStep;
        EXPECT_EQ(submap.fragment, n / 6);
        EXPECT_EQ(submap.last, first + kSubmapLength - 1);
        EXPECT_EQ(graph[submap.anchor].fragment, submap.fragment);
        EXPECT_EQ(graph[submap.anchor].position, first + 5);
        const auto views = submap.map.views().views();
        EXPECT_EQ(views.front().T_map_robot, Transform2()) << "the frame is that of the anchor";
        std::set<std::size_t> positions;
        for (const auto& view : views) {
            for (std::size_t keyframe = 0; keyframe < graph.size(); ++keyframe) {
                if (graph[keyframe].scan->points.data() != view.points.data()) continue;
                EXPECT_EQ(graph[keyframe].fragment, submap.fragment);
                positions.insert(graph[keyframe].position);
                const Transform2 expected = inverse(graph.pose(submap.anchor)) * graph.pose(keyframe);
                EXPECT_LT(distance_of(inverse(expected) * view.T_map_robot), 1e-9);
                EXPECT_LT(std::fabs(yaw_of(inverse(expected) * view.T_map_robot)), 1e-9);
            }
        }
        EXPECT_EQ(views.size(), kSubmapLength);
        EXPECT_EQ(positions.size(), kSubmapLength);
        EXPECT_EQ(*positions.begin(), first);
        EXPECT_EQ(*positions.rbegin(), submap.last);
    }
}

TEST(Submaps, AreAddedWhenTheirLastKeyframeIs) {
    std::mt19937 random(2);
    KeyframeGraph graph;
    Submaps submaps;
    for (std::size_t n = 0; n < 30; ++n) {
        add(graph, random_points(random), random_step(random));
        submaps.extend(graph, 0);
        EXPECT_EQ(submaps.size(), n + 1 < kSubmapLength ? 0U : (n + 1 - kSubmapLength) / kSubmapStep + 1U) << n;
    }
}

TEST(Submaps, DoNotChangeWhenKeyframesMove) {
    std::mt19937 random(3);
    KeyframeGraph graph = graph_of_two(random, 12);
    Submaps submaps;
    submaps.extend(graph, 1);
    const auto points_then = submaps[0].map.points().points();
    const std::vector<scan_matching::SurfacePoint> then(points_then.begin(), points_then.end());
    graph.move(1, transform_of({3.0, -2.0, 1.0}), true);
    submaps.extend(graph, 1);
    ASSERT_EQ(submaps.size(), 1U);
    submaps[0].map.release();
    EXPECT_TRUE(std::ranges::equal(submaps[0].map.points().points(), then));
}

TEST(KeyframeMap, IsComputedAgainWithEqualResultsAfterItsRelease) {
    std::mt19937 random(4);
    const KeyframeGraph graph = graph_of_two(random, 12);
    KeyframeMap map(graph.views_around(10, 0, 11));
    const auto look = [&] {
        std::vector<double> seen;
        std::mt19937 places(5);
        for (int n = 0; n < 2000; ++n) {
            const double x = uniform(places, -8.0, 8.0);
            const double y = uniform(places, -8.0, 8.0);
            const auto near = map.points().nearest({.x = static_cast<float>(x), .y = static_cast<float>(y)}, 0.2F);
            seen.push_back(near.point != nullptr ? static_cast<double>(near.squared_distance) : -1.0);
            seen.push_back(map.space().is_free(x, y) ? 1.0 : map.space().is_near_point(x, y) ? 2.0 : 0.0);
        }
        return seen;
    };
    const auto before = look();
    EXPECT_GT(std::ranges::count(before, 1.0), 100) << "free";
    EXPECT_GT(std::ranges::count(before, 2.0), 100) << "near points";
    map.release();
    EXPECT_EQ(look(), before);
}

} // namespace
} // namespace scanloom::slam

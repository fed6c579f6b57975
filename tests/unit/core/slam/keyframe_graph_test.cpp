#include "core/slam/keyframe_graph.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::slam {
namespace {

using scan_matching::transform_of;
using testing_support::uniform;

KeyframeGraph random_chain(std::mt19937& random, std::size_t keyframes) {
    KeyframeGraph graph;
    for (std::size_t n = 0; n < keyframes; ++n) {
        const Pose2 step{uniform(random, 0.5, 1.5), uniform(random, -0.5, 0.5), uniform(random, -0.8, 0.8)};
        add(graph, std::make_shared<const ScanPoints>(), transform_of(step));
    }
    return graph;
}

TEST(KeyframeGraph, DistancesAreThoseOfAllPaths) {
    std::mt19937 random(1);
    for (int round = 0; round < 20; ++round) {
        const std::size_t size = 2 + random() % 25;
        KeyframeGraph graph = random_chain(random, size);
        for (std::size_t n = 0; n < size / 4; ++n) {
            const std::size_t from = random() % size;
            const std::size_t to = random() % size;
            if (from == to) continue;
            Edge edge{std::min(from, to), std::max(from, to), Transform2(), information_of(0.1, 0.1), true};
            edge.weight = random() % 3 == 0 ? 0.4 : 1.0;
            graph.add_loop(edge);
        }
        // Floyd and Warshall: every pair by way of every keyframe.
        std::vector<std::vector<double>> ways(size, std::vector<double>(size, 1e9));
        for (const Edge& edge : graph.edges()) {
            if (edge.is_robust && edge.weight < 0.5) continue;
            const double way =
                edge.is_robust ? KeyframeGraph::kLoopLength : graph[edge.to].travelled - graph[edge.from].travelled;
            for (auto* pair : {&ways[edge.from][edge.to], &ways[edge.to][edge.from]}) *pair = std::min(*pair, way);
        }
        for (std::size_t n = 0; n < size; ++n) ways[n][n] = 0.0;
        for (std::size_t k = 0; k < size; ++k) {
            for (std::size_t i = 0; i < size; ++i) {
                for (std::size_t j = 0; j < size; ++j) ways[i][j] = std::min(ways[i][j], ways[i][k] + ways[k][j]);
            }
        }
        const std::size_t from = random() % size;
        const auto distances = graph.distances_from(from);
        for (std::size_t n = 0; n < size; ++n) ASSERT_NEAR(distances[n], ways[from][n], 1e-9);
    }
}

TEST(KeyframeGraph, PosesFollowTheEdges) {
    std::mt19937 random(2);
    const KeyframeGraph graph = random_chain(random, 10);
    ASSERT_EQ(graph.size(), 10U);
    ASSERT_EQ(graph.edges().size(), 9U);
    for (const Edge& edge : graph.edges()) {
        EXPECT_EQ(edge.to, edge.from + 1);
        EXPECT_EQ(graph.pose(edge.to), graph.pose(edge.from) * edge.T_from_to);
        const double way = std::hypot(edge.T_from_to.x, edge.T_from_to.y) + 0.2 * std::fabs(yaw_of(edge.T_from_to));
        EXPECT_NEAR(graph[edge.to].travelled - graph[edge.from].travelled, way, 1e-12);
    }
}

TEST(KeyframeGraph, ViewsAreOrderedByTheirDistanceInTime) {
    std::mt19937 random(3);
    const KeyframeGraph graph = random_chain(random, 10);
    const auto views = graph.views_around(5, 2, 6);
    std::vector<std::size_t> order;
    for (const auto& view : views.views()) {
        for (std::size_t n = 0; n < graph.size(); ++n) {
            const Transform2 off = inverse(inverse(graph.pose(5)) * graph.pose(n)) * view.T_map_robot;
            if (std::hypot(off.x, off.y) < 1e-9) order.push_back(n);
        }
    }
    EXPECT_THAT(order, testing::ElementsAre(5, 6, 4, 3, 2));
    EXPECT_EQ(views.views().front().T_map_robot, Transform2());
}

/// Poses that robots send can be anywhere, and the memory of a map grows with its extent.
TEST(KeyframeGraph, MapsAreBoundedWhateverPosesAreGiven) {
    KeyframeGraph graph;
    for (int n = 0; n < 12; ++n) {
        const double wrong = n == 3 ? 1500.0 : n == 7 ? kMapRadius + 1.0 : 0.0;
        graph.add_given(0, std::make_shared<const ScanPoints>(), {n * 1.0 + wrong, 0.0, {}});
    }
    EXPECT_EQ(graph.views_around(5, 0, 11).views().size(), 10U);
    const auto around_the_wrong_one = graph.views_around(3, 0, 11);
    ASSERT_EQ(around_the_wrong_one.views().size(), 1U);
    EXPECT_EQ(around_the_wrong_one.views().front().T_map_robot, Transform2());
    graph.freeze(true);
    EXPECT_EQ(graph.views_near(5, 35, {3.0, 0.0, {}}).views().size(), 10U);
    EXPECT_TRUE(graph.views_near(5, 35, {1500.0, 0.0, {}}).views().empty()) << "the robot is far beyond them";
}

TEST(KeyframeGraph, ALoopMovesTheKeyframesBetween) {
    KeyframeGraph graph;
    for (int n = 0; n < 21; ++n) { // a square of 5 m, each of its four turns by 0.02 rad too large
        const bool turns = n > 0 && n % 5 == 0;
        add(graph, std::make_shared<const ScanPoints>(),
            transform_of({n == 0 ? 0.0 : 1.0, 0.0, turns ? std::numbers::pi / 2.0 + 0.02 : 0.0}));
    }
    EXPECT_GT(std::hypot(graph.pose(20).x, graph.pose(20).y), 0.1);
    graph.add_loop({0, 20, Transform2(), information_of(0.02, 0.005), true});
    graph.optimize_after_jump();
    EXPECT_LT(std::hypot(graph.pose(20).x, graph.pose(20).y), 0.03);
    EXPECT_NEAR(graph.pose(10).x, 5.0, 0.15);
    EXPECT_NEAR(graph.pose(10).y, 5.0, 0.15);
    EXPECT_GT(graph.edges().back().weight, 0.9);
    graph.remove_loops([](const Edge& edge) { return edge.from == 0; });
    EXPECT_EQ(graph.edges().size(), 20U) << "edges of the path stay";
}

} // namespace
} // namespace scanloom::slam

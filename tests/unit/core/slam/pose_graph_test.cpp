#include "core/slam/pose_graph.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"
#include "tests/unit/core/slam/pose_graph_oracle.hpp"

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <vector>

namespace scanloom::slam {
namespace {

using namespace testing_support;
using scan_matching::transform_of;
using testing::Each;
using testing::Field;
using testing::Gt;
using testing_support::uniform;

constexpr std::array<std::size_t, 1> kFirst = {0};
constexpr OptimizeOptions kExact{.max_iterations = 100, .step_limit = 1e-12};

Transform2 random_motion(std::mt19937& random, double position, double yaw) {
    return transform_of(
        {uniform(random, -position, position), uniform(random, -position, position), uniform(random, -yaw, yaw)});
}

/// Returns the information of correlated errors of a few centimetres and degrees.
Information random_information(std::mt19937& random) {
    Eigen::Matrix3d root;
    for (double& element : root.reshaped()) element = uniform(random, -10.0, 10.0);
    const Eigen::Matrix3d full = root * root.transpose() + 300.0 * Eigen::Matrix3d::Identity();
    return {full(0, 0), full(0, 1), full(0, 2), full(1, 1), full(1, 2), full(2, 2)};
}

/// Returns a chain of nodes with noisy loops. The first few loops are wrong.
Graph random_graph(std::mt19937& random, std::size_t nodes, std::size_t loops, std::size_t wrong_loops) {
    Graph graph;
    std::vector<Transform2> truth = {{}};
    while (truth.size() < nodes) {
        truth.push_back(truth.back() * Transform2{1.0, 0.0, {}} * random_motion(random, 0.3, 0.8));
    }
    const auto connect = [&](std::size_t from, std::size_t to, double noise, bool is_robust) {
        const Transform2 measured = inverse(truth[from]) * truth[to] * random_motion(random, noise, 0.5 * noise);
        graph.edges.push_back({from, to, measured, random_information(random), is_robust});
    };
    for (std::size_t node = 1; node < nodes; ++node) connect(node - 1, node, 0.03, false);
    for (std::size_t loop = 0; loop < loops; ++loop) {
        const std::size_t from = random() % nodes;
        connect(from, (from + 1 + random() % (nodes - 1)) % nodes, loop < wrong_loops ? 3.0 : 0.03, true);
    }
    graph.poses = {truth[0]};
    for (std::size_t node = 1; node < nodes; ++node) {
        graph.poses.push_back(graph.poses.back() * graph.edges[node - 1].T_from_to);
    }
    return graph;
}

/// Returns nodes on a circle, each with an edge to the next, as they are measured with a constant error of the yaw; and
/// as the last edge, an exact one that closes the loop.
/// @param radius     metres
/// @param yaw_error  radians an edge
Graph ring(std::size_t nodes, double radius, double yaw_error) {
    Graph graph;
    const double turn = 2.0 * std::numbers::pi / static_cast<double>(nodes);
    const Transform2 exact = transform_of({radius * std::sin(turn), radius * (1.0 - std::cos(turn)), turn});
    graph.poses = {{}};
    for (std::size_t node = 1; node < nodes; ++node) {
        graph.edges.push_back(
            {node - 1, node, exact * transform_of({0.0, 0.0, yaw_error}), information_of(0.05, 0.01)});
        graph.poses.push_back(graph.poses.back() * graph.edges.back().T_from_to);
    }
    graph.edges.push_back({nodes - 1, 0, exact, information_of(0.02, 0.005), true});
    return graph;
}

void expect_equal(std::span<const Transform2> poses, const std::vector<double>& expected, double tolerance) {
    ASSERT_EQ(3 * poses.size(), expected.size());
    for (std::size_t node = 0; node < poses.size(); ++node) {
        EXPECT_NEAR(poses[node].x, expected[3 * node], tolerance) << "node " << node;
        EXPECT_NEAR(poses[node].y, expected[3 * node + 1], tolerance) << "node " << node;
        EXPECT_NEAR(poses[node].rotation.sin, std::sin(expected[3 * node + 2]), tolerance) << "node " << node;
        EXPECT_NEAR(poses[node].rotation.cos, std::cos(expected[3 * node + 2]), tolerance) << "node " << node;
    }
}

void expect_near(const Transform2& pose, const Transform2& expected, double tolerance) {
    EXPECT_NEAR(pose.x, expected.x, tolerance);
    EXPECT_NEAR(pose.y, expected.y, tolerance);
    EXPECT_NEAR(pose.rotation.sin, expected.rotation.sin, tolerance);
    EXPECT_NEAR(pose.rotation.cos, expected.rotation.cos, tolerance);
}

TEST(PoseGraph, EqualsDenseOptimisation) {
    std::mt19937 random(5);
    for (int round = 0; round < 12; ++round) {
        const std::size_t nodes = 5 + random() % 36;
        Graph graph = random_graph(random, nodes, nodes, 0);
        for (Edge& edge : graph.edges) edge.is_robust = false;
        DenseOracle oracle(graph, 4.0);
        EXPECT_TRUE(optimize(graph.poses, kFirst, graph.edges, kExact));
        expect_equal(graph.poses, oracle.optimize(10), 1e-9);
        EXPECT_THAT(graph.edges, Each(Field(&Edge::weight, 1.0)));
    }
}

void expect_dense_optimisation_with_wrong_loops(int rounds) {
    std::mt19937 random(6);
    int switched_off = 0;
    for (int round = 0; round < rounds; ++round) {
        const std::size_t nodes = 5 + random() % 36;
        Graph graph = random_graph(random, nodes, nodes, 3);
        DenseOracle oracle(graph, 4.0);
        EXPECT_TRUE(optimize(graph.poses, kFirst, graph.edges, kExact));
        expect_equal(graph.poses, oracle.optimize(40), 1e-6);
        switched_off += static_cast<int>(std::ranges::count_if(graph.edges, [](auto& e) { return e.weight < 0.5; }));
    }
    EXPECT_GT(switched_off, rounds);
}

TEST(PoseGraph, EqualsDenseOptimisationWithWrongLoops) { expect_dense_optimisation_with_wrong_loops(4); }

TEST(PoseGraphTrials, EqualsDenseOptimisationWithWrongLoops) { expect_dense_optimisation_with_wrong_loops(30); }

TEST(PoseGraph, FirstStepsEqualThoseOfDenseOptimisation) {
    std::mt19937 random(7);
    Graph graph = random_graph(random, 30, 40, 5);
    DenseOracle oracle(graph, 9.0);
    EXPECT_FALSE(optimize(graph.poses, kFirst, graph.edges, {.max_iterations = 2, .robust_scale = 9.0}));
    expect_equal(graph.poses, oracle.optimize(2), 1e-6);
}

TEST(PoseGraph, SwitchesWrongLoopOff) {
    Graph graph = ring(60, 10.0, 0.0002);
    graph.edges.push_back({10, 40, transform_of({1.0, 2.0, 0.5}), information_of(0.02, 0.005), true});
    EXPECT_TRUE(optimize(graph.poses, kFirst, graph.edges, {.max_iterations = 50}));
    EXPECT_LT(graph.edges.back().weight, 0.01);
    graph.edges.pop_back();
    EXPECT_THAT(graph.edges, Each(Field(&Edge::weight, Gt(0.99))));
    expect_near(inverse(graph.poses[59]) * graph.poses[0], graph.edges.back().T_from_to, 0.01);
}

TEST(PoseGraph, AcceptsLargeCorrectionOnlyGradually) {
    Graph plain = ring(200, 20.0, 0.002);
    Graph gradual = plain;
    const OptimizeOptions options{.max_iterations = 20};
    optimize(plain.poses, kFirst, plain.edges, options);
    EXPECT_LT(plain.edges.back().weight, 0.1);
    EXPECT_TRUE(optimize_gradually(gradual.poses, kFirst, gradual.edges, options));
    EXPECT_GT(gradual.edges.back().weight, 0.9);
    expect_near(inverse(gradual.poses[199]) * gradual.poses[0], gradual.edges.back().T_from_to, 0.05);
}

TEST(PoseGraph, GradualOptimisationSwitchesWrongLoopOff) {
    Graph graph = ring(60, 10.0, 0.0002);
    graph.edges.push_back({10, 40, transform_of({1.0, 2.0, 0.5}), information_of(0.02, 0.005), true});
    EXPECT_TRUE(optimize_gradually(graph.poses, kFirst, graph.edges, {.max_iterations = 50}));
    EXPECT_LT(graph.edges.back().weight, 0.01);
    EXPECT_GT(graph.edges[59].weight, 0.99);
}

TEST(PoseGraph, KeepsFixedNodes) {
    std::mt19937 random(8);
    Graph graph = random_graph(random, 30, 30, 2);
    const auto before = graph.poses;
    const std::array<std::size_t, 3> fixed = {17, 4, 29};
    optimize(graph.poses, fixed, graph.edges);
    for (std::size_t node = 0; node < before.size(); ++node) {
        EXPECT_EQ(graph.poses[node] == before[node], std::ranges::find(fixed, node) != fixed.end()) << "node " << node;
    }
}

TEST(PoseGraph, SolvesEachSideOfFixedNodeAlone) {
    std::mt19937 random(9);
    Graph graph = random_graph(random, 12, 0, 0);
    graph.edges.push_back({0, 5, random_motion(random, 4.0, 0.5), information_of(0.1, 0.1)});
    const auto before = graph.poses;
    const std::array<std::size_t, 2> fixed = {5, 0};
    EXPECT_TRUE(optimize(graph.poses, fixed, graph.edges));
    for (std::size_t node = 6; node < before.size(); ++node) expect_near(graph.poses[node], before[node], 1e-9);
}

TEST(PoseGraph, RepeatedRunsAreBitIdentical) {
    std::mt19937 random(10);
    const Graph graph = random_graph(random, 200, 200, 10);
    Graph first = graph;
    Graph second = graph;
    optimize_gradually(first.poses, kFirst, first.edges);
    optimize_gradually(second.poses, kFirst, second.edges);
    EXPECT_EQ(first.poses, second.poses);
}

TEST(PoseGraph, ResultIsEqualOnEveryProcessor) {
    std::mt19937 random(12);
    const auto next = [&](double high) { return high * static_cast<double>(random()) / 0x1p32; };
    std::vector<Transform2> poses(100);
    for (Transform2& pose : poses) pose = transform_of({next(30.0), next(30.0), next(6.0)});
    std::vector<Edge> edges;
    for (std::size_t edge = 0; edge < 250; ++edge) {
        const std::size_t to = edge < 99 ? edge + 1 : 30 + edge % 70;
        const Transform2 measured = transform_of({next(2.0), next(1.0), next(0.1)});
        const Information information{2500.0, next(900.0), next(900.0), 2500.0, next(900.0), 10000.0};
        edges.push_back({edge < 99 ? edge : edge % 29, to, measured, information, edge >= 99});
    }
    optimize_gradually(poses, kFirst, edges);
    EXPECT_EQ(poses[50],
              (Transform2{0x1.76fa4b37a4807p+5, 0x1.35bc14e7c3fd9p+3, {0x1.4a96e6da1c604p-1, 0x1.86f75c2f0a354p-1}}));
    EXPECT_EQ(poses[99],
              (Transform2{0x1.19d8eea71cd79p+3, 0x1.37e9103d132f9p+5, {-0x1.caf9fd1155866p-4, -0x1.fcc68318cdefbp-1}}));
}

TEST(PoseGraph, OrderOfEdgesIsIrrelevant) {
    std::mt19937 random(11);
    Graph graph = random_graph(random, 40, 60, 6);
    Graph shuffled = graph;
    std::ranges::shuffle(shuffled.edges, random);
    optimize(graph.poses, kFirst, graph.edges, kExact);
    optimize(shuffled.poses, kFirst, shuffled.edges, kExact);
    for (std::size_t node = 0; node < graph.poses.size(); ++node) {
        expect_near(shuffled.poses[node], graph.poses[node], 1e-9);
    }
}

TEST(PoseGraph, AcceptsEmptyGraphAndSingleNode) {
    EXPECT_TRUE(optimize({}, {}, {}));
    EXPECT_TRUE(optimize_gradually({}, {}, {}));
    const Transform2 pose = transform_of({3.0, 4.0, 0.5});
    std::array poses = {pose};
    EXPECT_TRUE(optimize(poses, {}, {}));
    EXPECT_TRUE(optimize(poses, kFirst, {}));
    EXPECT_EQ(poses[0], pose);
}

TEST(PoseGraph, HoldsFirstNodeOfComponentWithoutFixedNode) {
    const Transform2 measured = transform_of({1.0, 0.5, 0.1});
    std::array<Transform2, 6> poses = {{{}, {5.0, 0.0, {}}, {9.0, 9.0, {}}, {2.0, 2.0, {}}, {6.0, 6.0, {}}, {}}};
    std::array<Edge, 3> edges = {{{3, 0, measured, information_of(0.1, 0.1)},
                                  {4, 1, measured, information_of(0.1, 0.1)},
                                  {2, 4, measured, information_of(0.1, 0.1)}}};
    constexpr std::array<std::size_t, 1> kFixed = {3};
    EXPECT_TRUE(optimize(poses, kFixed, edges, kExact));
    expect_near(poses[0], poses[3] * measured, 1e-9); // 3 is fixed
    EXPECT_EQ(poses[3], (Transform2{2.0, 2.0, {}}));
    EXPECT_EQ(poses[1], (Transform2{5.0, 0.0, {}})); // the first of 1, 2, 4
    expect_near(poses[4], poses[1] * inverse(measured), 1e-9);
    expect_near(poses[2], poses[4] * inverse(measured), 1e-9);
    EXPECT_EQ(poses[5], Transform2{});
}

TEST(PoseGraph, ParallelEdgesCountTwice) {
    std::array<Transform2, 2> poses = {};
    std::array<Edge, 3> edges = {{{0, 1, {1.0, 0.0, {}}, information_of(0.1, 0.1)},
                                  {1, 0, {-1.0, 0.0, {}}, information_of(0.1, 0.1)},
                                  {0, 1, {4.0, 0.0, {}}, information_of(0.1, 0.1)}}};
    EXPECT_TRUE(optimize(poses, {}, edges, kExact));
    expect_near(poses[1], {2.0, 0.0, {}}, 1e-9);
}

TEST(PoseGraph, KeepsPosesIfEdgesLeaveNodeUndetermined) {
    std::array<Transform2, 2> poses = {};
    std::array<Edge, 1> edges = {{{0, 1, {1.0, 0.0, {}}, {.xx = 1.0, .yy = 1.0}}}};
    EXPECT_FALSE(optimize(poses, {}, edges));
    EXPECT_EQ(poses[1], Transform2{});
}

TEST(PoseGraph, CrossesHalfTurn) {
    std::array<Transform2, 2> poses = {transform_of({0.0, 0.0, 3.0}), transform_of({0.0, 0.0, -3.0})};
    std::array<Edge, 1> edges = {{{0, 1, transform_of({0.0, 0.0, 0.2}), information_of(0.1, 0.1)}}};
    EXPECT_TRUE(optimize(poses, {}, edges, kExact));
    expect_near(poses[1], transform_of({0.0, 0.0, 3.2}), 1e-12);
}

} // namespace
} // namespace scanloom::slam

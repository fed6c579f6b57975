#include "core/slam/loop_search.hpp"
#include "tests/unit/core/slam/other_buildings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace scanloom::slam {
namespace {

using scan_matching::transform_of;
using testing_support::Building;

/// Returns a laser that sees all around.
Sensor all_round_laser(double range) {
    Sensor laser = Building::laser();
    laser.angles = UniformAngles{-std::numbers::pi, std::numbers::pi / 90.0, 180};
    laser.range_max = range;
    return laser;
}

/// Keyframes on straight lines, whose estimated poses drift, and the loops between them.
class Loops {
public:
    /// @param turn   radians for each metre, of the drift
    /// @param laser  of the robot
    explicit Loops(double turn = 0.0, Sensor laser = Building::laser()) : turn_(turn), laser_(std::move(laser)) {}

    /// Drives on straight lines through points, and searches at each keyframe.
    void drive(const Building& building, const std::vector<Point2>& points) {
        for (std::size_t n = 0; n + 1 < points.size(); ++n) {
            const double length = std::hypot(points[n + 1].x - points[n].x, points[n + 1].y - points[n].y);
            const double yaw = std::atan2(points[n + 1].y - points[n].y, points[n + 1].x - points[n].x);
            for (double at = 0.0; at < length; at += 0.75) {
                add_at(building, {points[n].x + at * std::cos(yaw), points[n].y + at * std::sin(yaw), yaw});
            }
        }
    }

    /// Adds a keyframe, and searches around it.
    void add_at(const Building& building, const Pose2& truth) {
        const Transform2 pose = transform_of(truth);
        Transform2 step = truth_.empty() ? pose : inverse(truth_.back()) * pose;
        if (!truth_.empty()) step = step * transform_of({0.0, 0.0, turn_ * distance_of(step)});
        truth_.push_back(pose);
        reckoned_ = reckoned_ * step;
        auto scan = scan_matching::points_of(building.scan(laser_, truth, 0.01, random_), laser_);
        add(graph, std::make_shared<const ScanPoints>(std::move(scan)), step);
        search.search(graph, 0);
    }

    /// Returns the distance of the newest keyframe from where it is, metres.
    [[nodiscard]] double error() const { return distance_of(inverse(graph.pose(graph.size() - 1)) * truth_.back()); }

    /// Returns error() as it would be without loops.
    [[nodiscard]] double drift() const { return distance_of(inverse(reckoned_) * truth_.back()); }

    /// Returns the loop edges, each with its error in metres.
    [[nodiscard]] std::vector<std::pair<Edge, double>> edges() const {
        std::vector<std::pair<Edge, double>> loops;
        for (const Edge& edge : graph.edges()) {
            if (!edge.is_robust) continue;
            const Transform2 truth = inverse(truth_[edge.from]) * truth_[edge.to];
            loops.emplace_back(edge, distance_of(inverse(truth) * edge.T_from_to));
        }
        return loops;
    }

    KeyframeGraph graph;
    LoopSearch search;

private:
    double turn_;
    Sensor laser_;
    std::mt19937 random_{1};
    std::vector<Transform2> truth_;
    Transform2 reckoned_; // pose of the newest keyframe without loops
};

/// A lap of 36 m and a part of the next one in a hall: matches of single keyframes correct the drift.
const std::vector<Point2> kAroundTheHall{{1.5, 1.5}, {12.5, 1.5}, {12.5, 7.5}, {1.5, 7.5},
                                         {1.5, 1.5}, {12.5, 1.5}, {12.5, 5.0}};

TEST(LoopSearch, CorrectsALittleDriftByMatchesOfSingleKeyframes) {
    Loops loops(0.001);
    loops.drive(other_building(), kAroundTheHall);
    EXPECT_GT(loops.drift(), 0.2);
    EXPECT_LT(loops.error(), 0.1);
    EXPECT_GT(loops.search.figures().loops, 5U);
    EXPECT_EQ(loops.search.figures().loops, loops.edges().size());
    EXPECT_EQ(loops.search.figures().stretch_tests, 0U);
    EXPECT_GT(loops.search.optimization_count(), 0U);
    for (const auto& [edge, error] : loops.edges()) EXPECT_LT(error, 0.05) << edge.from << " to " << edge.to;
}

TEST(LoopSearch, ClosesTheLoopOfARingByAStretchOfTheTrajectory) {
    Loops loops(0.0003);
    loops.drive(ring_building(),
                {{10.0, 1.0}, {33.0, 1.0}, {33.0, 21.0}, {1.0, 21.0}, {1.0, 1.0}, {33.0, 1.0}, {33.0, 12.0}});
    EXPECT_GT(loops.drift(), 0.5);
    EXPECT_LT(loops.error(), 0.1);
    EXPECT_GT(loops.search.figures().stretches_accepted, 0U);
    for (const auto& [edge, error] : loops.edges()) EXPECT_LT(error, 0.1) << edge.from << " to " << edge.to;
}

TEST(LoopSearch, AddsNoEdgeToTheNewestPartOfTheTrajectory) {
    constexpr std::size_t kGap = 36;                     // keyframes after the end of a submap
    constexpr std::size_t kToTheEnd = kSubmapLength / 2; // keyframes, from its anchor
    Loops loops(0.0, all_round_laser(20.0));
    const Building hall = other_building();
    const auto round = [&](std::size_t n) { return Pose2{6.0 + 0.1 * static_cast<double>(n % 4), 2.0, 0.5}; };
    for (std::size_t n = 0; n < kGap + kSubmapLength - 1; ++n) loops.add_at(hall, round(n));
    EXPECT_EQ(loops.search.figures().matches, 0U);
    for (std::size_t n = 0; n < 20; ++n) loops.add_at(hall, round(n));
    ASSERT_GT(loops.edges().size(), 5U);
    std::size_t nearest = loops.graph.size();
    for (const auto& [edge, error] : loops.edges()) nearest = std::min(nearest, edge.to - edge.from);
    EXPECT_EQ(nearest, kGap + kToTheEnd);
}

/// The robot comes back to where it was, but finds another room there: what stays is enough for a match.
TEST(LoopSearch, AddsNoEdgeWhereTheSightContradictsTheOldMap) {
    for (const bool has_changed : {false, true}) {
        Loops loops;
        Building hall = other_building();
        loops.drive(hall, {kAroundTheHall.begin(), kAroundTheHall.begin() + 5});
        const LoopFigures before = loops.search.figures();
        if (has_changed) {
            for (const double x : {4.0, 6.5, 9.0, 11.5}) hall.add_box(x, 2.0, x + 0.8, 2.3);
        }
        loops.drive(hall, {{1.5, 1.5}, {12.5, 1.5}});
        EXPECT_GT(loops.search.figures().matches, before.matches + 5);
        EXPECT_EQ(loops.search.figures().loops == before.loops, has_changed);
    }
}

/// The laser sees 4 m: all hits have normals. Farther ones are too far from each other, and count as points, not lines.
TEST(LoopSearch, AddsNoEdgeWhereAStraightCorridorDoesNotDetermineThePosition) {
    for (const bool has_posts : {false, true}) {
        Building corridor;
        corridor.walls = {{{-60.0, 0.0}, {60.0, 0.0}}, {{-60.0, 2.0}, {60.0, 2.0}}};
        if (has_posts) {
            for (const double x : {-17.0, -8.0, -5.5, 1.3, 4.6, 12.2}) corridor.add_box(x, 0.0, x + 0.4, 0.4);
        }
        Loops loops(0.0, all_round_laser(4.0));
        loops.drive(corridor, {{-8.0, 1.0}, {8.0, 1.0}, {-8.0, 1.0}, {8.0, 1.0}});
        EXPECT_GT(loops.search.figures().matches, 10U);
        EXPECT_EQ(loops.edges().empty(), !has_posts);
    }
}

TEST(LoopSearch, AFragmentThatIsNotLocatedKnowsOnlyItsOwnPlaces) {
    for (const bool is_located : {false, true}) {
        Loops loops;
        loops.drive(other_building(), kAroundTheHall);
        KeyframeGraph& graph = loops.graph;
        std::size_t fragment = 0;
        const std::size_t first = graph.size();
        const std::size_t matches = loops.search.figures().matches;
        for (std::size_t n = 0; n < 12; ++n) { // a robot that drives where the first one did
            auto scan = graph[n].scan;
            if (n == 0) fragment = graph.begin_fragment(1, scan, graph.pose(0), is_located);
            if (n > 0) graph.add(fragment, scan, inverse(graph.pose(n - 1)) * graph.pose(n));
            loops.search.search(graph, fragment);
        }
        const auto is_between = [&](const Edge& edge) { return edge.from < first && edge.to >= first; };
        EXPECT_EQ(std::ranges::any_of(graph.edges(), is_between), is_located);
        EXPECT_EQ(loops.search.figures().matches > matches, is_located);
    }
}

} // namespace
} // namespace scanloom::slam

#include "core/slam/stretch_test.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

namespace scanloom::slam {
namespace {

using scan_matching::transform_of;
using testing_support::Building;

constexpr std::size_t kScansOfKeyframe = 8;

/// The keyframes of a drive with their true poses, but for one step that is too long: all keyframes from there on are
/// off.
struct Drifted {
    Drifted(const Building& building, std::span<const Point2> points, double error) {
        const Drive drive = drive_along(building, points, {}, 1);
        const std::size_t count = (drive.truth.size() - 1) / kScansOfKeyframe + 1;
        for (std::size_t n = 0; n < count; ++n) {
            const Transform2 truth = transform_of(drive.truth[n * kScansOfKeyframe]);
            Transform2 step = n == 0 ? truth : inverse(before) * truth;
            if (n == 3 * count / 5) step.x += error;
            auto scan = scan_matching::points_of(drive.scans[n * kScansOfKeyframe], drive.laser);
            add(graph, std::make_shared<const ScanPoints>(std::move(scan)), step);
            before = truth;
        }
        correction = before * inverse(graph.pose(count - 1));
    }

    KeyframeGraph graph;
    Transform2 before;     // true pose of the newest keyframe
    Transform2 correction; // of the newest keyframe
};

const std::vector<Point2> kLapAndMore{{10.0, 1.0}, {33.0, 1.0}, {33.0, 21.0}, {1.0, 21.0},
                                      {1.0, 1.0},  {33.0, 1.0}, {33.0, 12.0}};

TEST(StretchTest, AcceptsTheCorrectionOfADriftedLap) {
    Drifted drifted(ring_building(), kLapAndMore, 0.45);
    auto& graph = drifted.graph;
    const std::size_t newest = graph.size() - 1;
    const std::size_t edges = graph.edges().size();
    const Transform2 pose = graph.pose(newest);
    const Transform2 false_loop = inverse(graph.pose(2)) * pose * Transform2{2.0, 0.0};
    graph.add_loop({2, newest, false_loop, information_of(0.02, 0.005), true});
    ASSERT_TRUE(accept_stretch(graph, {newest, 20, drifted.correction, 3.0}));
    EXPECT_EQ(graph.pose(newest), pose) << "the test itself moves nothing";
    ASSERT_GT(graph.edges().size(), edges + 3);
    for (const Edge& edge : graph.edges().subspan(edges)) {
        EXPECT_NE(edge.T_from_to, false_loop);
        if (edge.to < 3 * graph.size() / 5 + 3) continue; // close to the step that is too long
        const Transform2 truth = inverse(graph.pose(edge.from)) * (drifted.correction * graph.pose(edge.to));
        const Transform2 off = inverse(edge.T_from_to) * truth;
        EXPECT_LT(distance_of(off), 0.1) << edge.from << " to " << edge.to;
    }
    graph.optimize_after_jump();
    EXPECT_LT(distance_of(inverse(graph.pose(newest)) * drifted.before), 0.1);
}

TEST(StretchTest, RefusesALargeCorrectionWhileThePathMayBeInUnseenSpace) {
    Drifted drifted(ring_building(), kLapAndMore, 2.0);
    const std::size_t edges = drifted.graph.edges().size();
    EXPECT_FALSE(accept_stretch(drifted.graph, {drifted.graph.size() - 1, 20, drifted.correction, 3.0}));
    EXPECT_EQ(drifted.graph.edges().size(), edges);
}

TEST(StretchTest, RefusesAFalseCorrection) {
    Drifted drifted(ring_building(), kLapAndMore, 0.0);
    const std::size_t edges = drifted.graph.edges().size();
    for (const double shift : {-2.5, 2.5, 4.0}) {
        const bool accepted =
            accept_stretch(drifted.graph, {drifted.graph.size() - 1, 20, Transform2{shift, 0.0}, 1.0});
        if (!accepted) continue;
        for (const Edge& edge : drifted.graph.edges().subspan(edges)) { // it may confirm where the trajectory is
            const Transform2 truth = inverse(drifted.graph.pose(edge.from)) * drifted.graph.pose(edge.to);
            EXPECT_LT(distance_of(inverse(edge.T_from_to) * truth), 0.1);
        }
    }
}

TEST(StretchTest, RefusesWhatAnAmbiguousCorridorCannotDecide) {
    Building corridor;
    corridor.walls = {{{-20.0, 0.0}, {80.0, 0.0}}, {{-20.0, 2.0}, {80.0, 2.0}}};
    for (double x = -19.0; x < 79.0; x += 2.0) corridor.add_box(x, 0.0, x + 0.4, 0.4);
    const std::vector<Point2> there_and_back{{0.0, 1.0}, {40.0, 1.0}, {0.0, 1.0}, {30.0, 1.0}};
    Drifted drifted(corridor, there_and_back, 2.0); // by just the distance of two posts
    const std::size_t edges = drifted.graph.edges().size();
    EXPECT_FALSE(accept_stretch(drifted.graph, {drifted.graph.size() - 1, 20, drifted.correction, 3.0}));
    EXPECT_EQ(drifted.graph.edges().size(), edges);
}

} // namespace
} // namespace scanloom::slam

#include "server/exchange/trajectory_text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace scanloom::exchange {
namespace {

constexpr double kRight = std::numbers::pi / 2.0;

const std::array<localization::StampedPose, 2> kPoses{
    localization::StampedPose{976052857.25, {1.5, -2.0, 0.0}},
    localization::StampedPose{976052857.5, {1.5, -1.0, kRight}},
};

TEST(TrajectoryText, TumHasStampsPositionsAndQuaternions) {
    EXPECT_EQ(tum_text(kPoses), "976052857.250000 1.500000 -2.000000 0 0 0 0.000000000 1.000000000\n"
                                "976052857.500000 1.500000 -1.000000 0 0 0 0.707106781 0.707106781\n");
    EXPECT_EQ(tum_text({}), "");
}

TEST(TrajectoryText, KittiHasMatrices) {
    EXPECT_EQ(kitti_text(kPoses), "1.000000000 -0.000000000 0 1.500000 0.000000000 1.000000000 0 -2.000000 0 0 1 0\n"
                                  "0.000000000 -1.000000000 0 1.500000 1.000000000 0.000000000 0 -1.000000 0 0 1 0\n");
}

TEST(TrajectoryText, G2oHasLocatedKeyframesAndEdgesThatCount) {
    localization::PoseGraphView graph;
    graph.keyframes = {{0, {0.0, 0.0, 0.0}, true},
                       {0, {1.0, 0.5, kRight}, true},
                       {1, {7.0, 7.0, 0.0}, false},
                       {0, {2.0, 0.0, -kRight}, true},
                       {7, {4.0, 0.0, 0.0}, true}}; // of the map that was there before the robots
    const slam::Information information{1.0, 2.0, 3.0, 4.0, 5.0, 6.5};
    const auto edge = [&](std::size_t from, std::size_t to, const Pose2& measured, double weight) {
        graph.edges.push_back({from, to, scan_matching::transform_of(measured), information, true, weight});
    };
    edge(0, 1, {1.0, 0.25, kRight}, 1.0);
    edge(1, 2, {1.0, 0.0, 0.0}, 1.0);  // to a keyframe in another frame
    edge(0, 3, {9.0, 9.0, 0.0}, 0.01); // switched off
    edge(4, 3, {9.0, 9.0, 0.0}, 1.0);
    EXPECT_EQ(g2o_text(graph, 2), "VERTEX_SE2 0 0.000000 0.000000 0.000000000\n"
                                  "VERTEX_SE2 1 1.000000 0.500000 1.570796327\n"
                                  "VERTEX_SE2 3 2.000000 0.000000 -1.570796327\n"
                                  "EDGE_SE2 0 1 1.000000 0.250000 1.570796327 1 2 3 4 5 6.5\n");
}

} // namespace
} // namespace scanloom::exchange

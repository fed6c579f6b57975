#include "core/landmarks/landmark.hpp"
#include "tests/support/standing_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

// Landmarks are objects in a room: not the whole room and not single beams, for one turn of a lidar up to hundreds.

namespace scanloom::landmarks {
namespace {

/// Returns the points of a stationary lidar in the map frame.
std::vector<Point2> capture(const sim::World& world, const Pose2& place, int turns) {
    sim::Random random(1);
    auto points = sim::standing_capture(world, place, turns, random);
    for (auto& point : points) point = transform(place, point);
    return points;
}

const std::vector<Pose2> kStands = {{-3.3, 1.2, 1.0}, {1.5, -3.0, 0.3}, {3.5, 3.4, -2.0}, {-3.5, -3.7, 0.0}};

/// Returns the cluster with the most points on the border of a box.
std::int32_t cluster_on(const sim::Box& box, const std::vector<Point2>& points, const Clustering& clustering) {
    std::vector<int> counts(clustering.clusters);
    const sim::Box around = sim::widened(box, 0.08);
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto cluster = clustering.cluster_of[n];
        if (cluster != kNoise && around.contains(points[n])) ++counts[static_cast<std::size_t>(cluster)];
    }
    return static_cast<std::int32_t>(std::ranges::max_element(counts) - counts.begin());
}

TEST(RoomLandmarks, AreNeitherOneClusterNorNoise) {
    const auto room = sim::make_room();
    for (const Pose2& place : kStands) {
        for (const int turns : {1, 10, 50}) {
            const auto points = capture(room, place, turns);
            const auto survey = survey_landmarks(points).value();
            const auto noise = std::ranges::count(survey.clustering.cluster_of, kNoise);
            EXPECT_GE(survey.landmarks.size(), 5U) << place.x << ", " << turns << " turns, eps " << survey.eps;
            EXPECT_LE(survey.landmarks.size(), 20U) << place.x << ", " << turns << " turns, eps " << survey.eps;
            EXPECT_LT(noise, static_cast<std::ptrdiff_t>(points.size() / 10)) << place.x << ", " << turns << " turns";
            for (const Landmark& landmark : survey.landmarks) EXPECT_LT(landmark.points, points.size() * 2 / 3);
        }
    }
}

TEST(RoomLandmarks, FreestandingFurnitureIsSeparateLandmarks) {
    const auto room = sim::make_room();
    const auto points = capture(room, kStands[0], 50);
    const auto clustering = survey_landmarks(points)->clustering;
    // Table, sofa, pillar and bed of make_room().
    std::vector<std::int32_t> clusters;
    for (const std::size_t solid : {8U, 9U, 10U, 12U}) {
        clusters.push_back(cluster_on(room.solids[solid], points, clustering));
    }
    std::ranges::sort(clusters);
    EXPECT_EQ(std::ranges::adjacent_find(clusters), clusters.end()) << "they are different ones";
}

TEST(RoomLandmarks, MoreTurnsFindSimilarLandmarks) {
    const auto room = sim::make_room();
    for (const Pose2& place : kStands) {
        const auto ten = find_landmarks(capture(room, place, 10)).value();
        const auto hundred = find_landmarks(capture(room, place, 100)).value();
        const double ratio = static_cast<double>(hundred.size()) / static_cast<double>(ten.size());
        EXPECT_GT(ratio, 0.5) << place.x;
        EXPECT_LT(ratio, 2.0) << place.x;
    }
}

} // namespace
} // namespace scanloom::landmarks

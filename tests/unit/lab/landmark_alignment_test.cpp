#include "core/landmarks/alignment.hpp"
#include "core/landmarks/pair_alignment.hpp"
#include "lab/door_room.hpp"
#include "lab/landmark_comparison.hpp"
#include "tests/unit/core/landmarks/pose_errors.hpp"

#include <gtest/gtest.h>

// Why align() uses surfaces: the landmarks of two captures determine the transform between a place and itself, but not
// between one place and the next, because other parts of objects are visible from there.

namespace scanloom::lab {
namespace {

struct LidarView {
    Pose2 T_map_lidar;
    std::vector<Point2> points; ///< in the lidar's frame
    SeenLandmarks in_map;
};

class LandmarkAlignment : public testing::Test {
protected:
    LidarView view(Door door, const Pose2& place) {
        const auto [sensor, scans] = take_capture(make_door_room(door), place, 20, sim::Noise{}, random_);
        return {place, points_of(scans, sensor), see_landmarks(points_in_map(scans, sensor)).value()};
    }

    /// Returns the transform in the map frame by the landmarks that match there; without an error it is the identity.
    static Result<landmarks::PairAlignment> by_landmarks(const LidarView& first, const LidarView& second) {
        std::vector<landmarks::PointPair> pairs;
        const auto comparison = compare(first.in_map, second.in_map).value();
        for (const auto& match : comparison.matches) {
            pairs.push_back({.first = first.in_map.survey.landmarks[match.first].position,
                             .second = second.in_map.survey.landmarks[match.second].position});
        }
        return landmarks::align_pairs_robustly(pairs, landmarks::kTolerance / 2.0);
    }

    static void expect_aligned_by_surfaces(const LidarView& first, const LidarView& second) {
        const auto found = landmarks::align({.points = first.points}, {.points = second.points}).value();
        const Pose2 truth = compose(inverse(first.T_map_lidar), second.T_map_lidar);
        EXPECT_EQ(found.certainty, landmarks::Certainty::kClear) << found.why;
        EXPECT_LT(landmarks::metres_off(found.T_first_second, truth), 0.02);
        EXPECT_LT(landmarks::degrees_off(found.T_first_second, truth), 0.5);
    }

private:
    sim::Random random_{1};
};

TEST_F(LandmarkAlignment, LandmarksAndSurfacesAlignOnePlaceWhileADoorMoves) {
    for (const Pose2& place : kDoorRoomPlaces) {
        const auto first = view(Door::kClosed, place);
        const auto second = view(Door::kOpen, place);
        const auto fit = by_landmarks(first, second);
        ASSERT_TRUE(fit) << fit.error().message;
        const Pose2 found = compose(fit->T_first_second, place);
        EXPECT_LT(landmarks::metres_off(found, place), 0.02);
        EXPECT_LT(landmarks::degrees_off(found, place), 0.5);
        expect_aligned_by_surfaces(first, second);
    }
}

TEST_F(LandmarkAlignment, OnlySurfacesAlignNeighbouringPlaces) {
    for (const Door door : {Door::kClosed, Door::kOpen}) {
        for (std::size_t n = 0; n < kDoorRoomPlaces.size(); ++n) {
            const auto first = view(Door::kClosed, kDoorRoomPlaces.at(n));
            const auto second = view(door, kDoorRoomPlaces.at((n + 1) % kDoorRoomPlaces.size()));
            EXPECT_FALSE(by_landmarks(first, second)) << "from place " << n + 1;
            expect_aligned_by_surfaces(first, second);
        }
    }
}

} // namespace
} // namespace scanloom::lab

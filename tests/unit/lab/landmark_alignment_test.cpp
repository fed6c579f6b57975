#include "core/landmarks/localization.hpp"
#include "core/landmarks/refinement.hpp"
#include "lab/door_room.hpp"
#include "lab/landmark_comparison.hpp"
#include "tests/unit/core/landmarks/pose_errors.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

// Why locate() uses surfaces: the landmarks of two captures determine the transform between a place and itself, but not
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
    /// Returns nullopt if fewer than four match, too few to notice a wrong one.
    static std::optional<Pose2> by_landmarks(const LidarView& first, const LidarView& second) {
        std::vector<landmarks::PointPair> pairs;
        const auto comparison = compare(first.in_map, second.in_map).value();
        for (const auto& match : comparison.matches) {
            pairs.push_back({.first = first.in_map.survey.landmarks[match.first].position,
                             .second = second.in_map.survey.landmarks[match.second].position});
        }
        return pairs.size() < 4 ? std::nullopt : landmarks::align_pairs(pairs);
    }

    static void expect_located_by_surfaces(const std::vector<LidarView>& mapped, const LidarView& view) {
        landmarks::ReferenceViews map;
        for (const auto& [place, points, in_map] : mapped) {
            landmarks::ReferenceView reference{.from = {place.x, place.y}};
            for (const Point2& point : points) reference.points.push_back(in_millimetres(transform(place, point)));
            map.push_back(std::make_shared<const landmarks::ReferenceView>(std::move(reference)));
        }
        const auto found = landmarks::locate(map, {.points = view.points}).value();
        EXPECT_EQ(found.certainty, landmarks::Certainty::kClear) << found.why;
        EXPECT_LT(landmarks::metres_off(found.T_first_second, view.T_map_lidar), 0.02);
        EXPECT_LT(landmarks::degrees_off(found.T_first_second, view.T_map_lidar), 0.5);
    }

private:
    sim::Random random_{1};
};

TEST_F(LandmarkAlignment, LandmarksAndSurfacesDetermineOnePlaceWhileADoorMoves) {
    for (const Pose2& place : kDoorRoomPlaces) {
        const auto first = view(Door::kClosed, place);
        const auto second = view(Door::kOpen, place);
        const auto fit = by_landmarks(first, second);
        ASSERT_TRUE(fit);
        const Pose2 found = compose(*fit, place);
        EXPECT_LT(landmarks::metres_off(found, place), 0.02);
        EXPECT_LT(landmarks::degrees_off(found, place), 0.5);
        expect_located_by_surfaces({first}, second);
    }
}

TEST_F(LandmarkAlignment, OnlySurfacesDetermineNeighbouringPlaces) {
    for (const Door door : {Door::kClosed, Door::kOpen}) {
        for (std::size_t n = 0; n < kDoorRoomPlaces.size(); ++n) {
            const auto second = view(door, kDoorRoomPlaces.at(n));
            std::vector<LidarView> mapped;
            for (std::size_t other = 1; other < kDoorRoomPlaces.size(); ++other) {
                mapped.push_back(view(Door::kClosed, kDoorRoomPlaces.at((n + other) % kDoorRoomPlaces.size())));
                EXPECT_FALSE(by_landmarks(mapped.back(), second)) << "place " << n + 1;
            }
            expect_located_by_surfaces(mapped, second);
        }
    }
}

} // namespace
} // namespace scanloom::lab

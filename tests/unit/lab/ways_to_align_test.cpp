#include "lab/alignment_methods.hpp"

#include "lab/door_room.hpp"
#include "lab/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

constexpr Pose2 kPlace{3.4, 2.2, -1.9};

class WaysToAlignTest : public testing::Test {
protected:
    SeenLandmarks seen(Door door, const Pose2& place = kPlace) {
        const auto capture = take_capture(make_door_room(door), place, 10, robot::Noise{}, random_);
        return see_landmarks(points_in_map(capture.scans, capture.sensor)).value();
    }

    /// Returns the landmarks as observed by a second lidar that is moved within the first lidar's map.
    static SeenLandmarks moved(SeenLandmarks seen, const Pose2& by) {
        for (auto& landmark : seen.survey.landmarks) landmark.position = transform(by, landmark.position);
        return seen;
    }

private:
    robot::Random random_{1};
};

AlignmentMethods ways_of(const SeenLandmarks& first, const SeenLandmarks& second) {
    const auto matches = compare(first, second)->matches;
    return align_by_both_methods({first, second, kPlace, kPlace}, matches).value();
}

TEST_F(WaysToAlignTest, LandmarksAndSurfacesAgreeIfADoorMoved) {
    const auto [by_landmarks, by_surfaces] = ways_of(seen(Door::kClosed), seen(Door::kOpen));
    ASSERT_TRUE(by_landmarks.fit) << by_landmarks.refusal;
    EXPECT_EQ(by_landmarks.refusal, "");
    EXPECT_GT(by_landmarks.fit->agreeing, 5U);
    EXPECT_LE(by_landmarks.fit->agreeing, by_landmarks.pairs);
    EXPECT_LT(by_landmarks.fit->error.metres, 0.02);
    EXPECT_LT(by_landmarks.fit->rms, 0.05);
    EXPECT_EQ(by_surfaces.alignment.certainty, landmarks::Certainty::kClear);
    EXPECT_LT(by_surfaces.error.metres, 0.02);
    EXPECT_LT(by_surfaces.error.degrees(), 0.5);
}

TEST_F(WaysToAlignTest, ErrorIsTheOffsetOfTheSecondLidar) {
    const auto first = seen(Door::kClosed);
    const Pose2 nudge{0.03, -0.04, 0.0}; // the transform reverts this offset
    const auto straight = ways_of(first, moved(first, nudge)).by_landmarks;
    ASSERT_TRUE(straight.fit);
    EXPECT_NEAR(straight.fit->error.metres, 0.05, 1e-9);
    EXPECT_NEAR(straight.fit->error.radians, 0.0, 1e-9);
    EXPECT_NEAR(straight.fit->rms, 0.0, 1e-9);

    // Around the lidar: the lidar keeps its place, at any distance from the map's origin.
    const Pose2 turn = compose(kPlace, compose({0.0, 0.0, 0.01}, inverse(kPlace)));
    const auto turned = ways_of(first, moved(first, turn)).by_landmarks;
    ASSERT_TRUE(turned.fit);
    EXPECT_NEAR(turned.fit->error.metres, 0.0, 1e-9);
    EXPECT_NEAR(turned.fit->error.radians, 0.01, 1e-9);
}

TEST_F(WaysToAlignTest, DisagreeingPairsAreExcluded) {
    const auto first = seen(Door::kClosed);
    auto second = first;
    second.survey.landmarks[2].position.x += 0.2;
    const auto [by_landmarks, by_surfaces] = ways_of(first, second);
    ASSERT_TRUE(by_landmarks.fit);
    EXPECT_EQ(by_landmarks.fit->agreeing, by_landmarks.pairs - 1);
    EXPECT_LT(by_landmarks.fit->error.metres, 1e-6);
}

TEST_F(WaysToAlignTest, TooFewPairsAreRefusedWhileSurfacesAlign) {
    const auto first = seen(Door::kClosed);
    const auto second = seen(Door::kOpen, {2.6, 1.8, 0.3});
    const auto ways = align_by_both_methods({first, second, kPlace, {2.6, 1.8, 0.3}}, {}).value();
    EXPECT_EQ(ways.by_landmarks.pairs, 0U);
    EXPECT_FALSE(ways.by_landmarks.fit);
    EXPECT_THAT(ways.by_landmarks.refusal, HasSubstr("pairs with weight: 0;"));
    EXPECT_EQ(ways.by_surfaces.alignment.certainty, landmarks::Certainty::kClear) << ways.by_surfaces.alignment.why;
    EXPECT_LT(ways.by_surfaces.error.metres, 0.02);
}

} // namespace
} // namespace scanloom::lab

#include "core/landmarks/alignment.hpp"
#include "tests/support/angles.hpp"
#include "tests/support/standing_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scanloom::landmarks {
namespace {

using sim::Box;
using sim::TwoCaptures;
using testing::HasSubstr;

struct Off {
    double metres;
    double radians;
    [[nodiscard]] bool is_right() const { return metres < 0.02 && radians < 0.5 * kDegree; }
};

Off off(const Pose2& pose, const Pose2& ground_truth) {
    const Pose2 between = compose(inverse(ground_truth), pose);
    return {std::hypot(between.x, between.y), std::abs(between.yaw)};
}

/// Returns a room around the origin that is empty except for `things`.
sim::World room_of(double half_width, double half_height, const std::vector<Box>& things = {}) {
    std::vector<Box> solids = {{-half_width - 1.0, -half_height - 1.0, half_width + 1.0, -half_height},
                               {-half_width - 1.0, half_height, half_width + 1.0, half_height + 1.0},
                               {-half_width - 1.0, -half_height - 1.0, -half_width, half_height + 1.0},
                               {half_width, -half_height - 1.0, half_width + 1.0, half_height + 1.0}};
    solids.insert(solids.end(), things.begin(), things.end());
    return sim::make_world("test", std::move(solids), {{-half_width, -half_height, half_width, half_height}});
}

TwoCaptures captures_at(const sim::World& world, const Pose2& first, const Pose2& second) {
    sim::Random random(1);
    auto before = standing_capture(world, first, 20, random);
    auto after = standing_capture(world, second, 20, random);
    return {std::move(before), std::move(after), compose(inverse(first), second)};
}

Alignment aligned(const TwoCaptures& captures) {
    return align({.points = captures.first}, {.points = captures.second}).value();
}

/// Returns the number of clear alignments and expects each of them to be correct.
int clear_of(const sim::World& world, int seeds) {
    int clear = 0;
    int beyond_sigmas = 0;
    for (int seed = 0; seed < seeds; ++seed) {
        const auto captures = two_captures(world, doors_of(world), static_cast<std::uint64_t>(seed));
        const auto alignment = aligned(captures);
        const Off error = off(alignment.T_first_second, captures.T_first_second);
        EXPECT_EQ(alignment.why.empty(), alignment.certainty == Certainty::kClear);
        if (alignment.certainty != Certainty::kClear) continue;
        ++clear;
        EXPECT_TRUE(error.is_right()) << world.name << ", seed " << seed << ": " << error.metres << " m, "
                                      << error.radians / kDegree << " degrees";
        beyond_sigmas += error.metres > 3.0 * alignment.position_sigma ? 1 : 0;
    }
    EXPECT_LE(beyond_sigmas, seeds / 50);
    return clear;
}

/// Three of the many scenes of AlignmentTrials.
TEST(Alignment, AlignsCapturesInRoomOfficeAndHall) {
    EXPECT_EQ(clear_of(sim::make_room(), 3), 3);
    EXPECT_GE(clear_of(sim::make_office(), 3), 2);
    EXPECT_GE(clear_of(sim::make_hall(), 3), 2);
}

TEST(AlignmentTrials, AlignsCapturesInARoomWithoutPrior) { EXPECT_GE(clear_of(sim::make_room(), 100), 99); }

TEST(AlignmentTrials, AlignsCapturesInAnOfficeWithoutPrior) {
    auto office = sim::make_office();
    office.starts = {{-15.0, -10.0, 15.0, 10.0}};
    EXPECT_GE(clear_of(office, 100), 95);
}

TEST(AlignmentTrials, AlignsCapturesInAHallOrReportsAmbiguity) { EXPECT_GE(clear_of(sim::make_hall(), 100), 95); }

/// Random scenes on which an earlier align() was clear and wrong: rotated by half a turn, shifted to other racks, or
/// shifted along racks.
TEST(Alignment, IsNotClearForASlightlyBetterWrongPose) {
    auto office = sim::make_office();
    office.starts = {{-15.0, -10.0, 15.0, 10.0}};
    const auto hall = sim::make_hall();
    for (const auto& [world, seed] : {std::pair{office, 1'887U},
                                      {office, 10'194U},
                                      {office, 10'519U},
                                      {office, 50'251U},
                                      {hall, 147U},
                                      {hall, 933U},
                                      {hall, 10'734U},
                                      {hall, 10'987U},
                                      {hall, 51'983U}}) {
        const auto captures = two_captures(world, doors_of(world), seed);
        const auto alignment = aligned(captures);
        if (alignment.certainty != Certainty::kClear) continue;
        EXPECT_TRUE(off(alignment.T_first_second, captures.T_first_second).is_right()) << world.name << " " << seed;
    }
}

TEST(Alignment, IsAmbiguousByAQuarterTurnInASquareRoom) {
    const auto captures = captures_at(room_of(3.0, 3.0), {0.5, 0.2, 0.3}, {-0.4, 0.6, 2.0});
    const auto alignment = aligned(captures);
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
    EXPECT_THAT(alignment.why, HasSubstr("another pose"));
    ASSERT_TRUE(alignment.competing_pose);
    const double turn =
        std::abs(normalize_angle(alignment.competing_pose->yaw - alignment.T_first_second.yaw)) / kDegree;
    EXPECT_NEAR(std::remainder(turn, 90.0), 0.0, 1.0);
    EXPECT_GT(turn, 80.0);
}

TEST(Alignment, IsClearOnlyIfCorrectInAFeaturelessRoom) {
    const auto square = room_of(3.0, 3.0);
    const auto oblong = room_of(4.0, 2.5);
    int ambiguous = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const auto captures = two_captures(seed % 2 == 0 ? square : oblong, {}, seed);
        const auto alignment = aligned(captures);
        ambiguous += alignment.certainty == Certainty::kAmbiguous ? 1 : 0;
        if (alignment.certainty != Certainty::kClear) continue; // otherwise the rivals are beyond distance_max
        EXPECT_TRUE(off(alignment.T_first_second, captures.T_first_second).is_right()) << "seed " << seed;
    }
    EXPECT_GE(ambiguous, 6);
}

TEST(Alignment, IsClearInASquareRoomWithATable) {
    const auto world = room_of(3.0, 3.0, {{-3.0, -3.0, -2.2, -2.2}});
    const auto captures = captures_at(world, {0.5, 0.2, 0.3}, {-0.4, 0.6, 2.0});
    const auto alignment = aligned(captures);
    EXPECT_EQ(alignment.certainty, Certainty::kClear) << alignment.why;
    EXPECT_TRUE(off(alignment.T_first_second, captures.T_first_second).is_right());
    EXPECT_GT(alignment.inlier_ratio, 0.9);
    EXPECT_LT(alignment.outlier_ratio, 0.01);
}

TEST(Alignment, IsAmbiguousIfACupboardMovedToTheOppositeCorner) {
    sim::Random random(3);
    const Pose2 here{0.5, 0.2, 0.3};
    const Pose2 there{-0.4, 0.6, 2.0};
    const auto before = standing_capture(room_of(3.0, 2.0, {{2.7, 1.7, 3.0, 2.0}}), here, 20, random);
    const auto after = standing_capture(room_of(3.0, 2.0, {{-3.0, -2.0, -2.7, -1.7}}), there, 20, random);
    EXPECT_EQ(align({.points = before}, {.points = after})->certainty, Certainty::kAmbiguous);
}

TEST(Alignment, IsNotClearIfACrateMovedAlongACorridor) {
    for (const double moved : {0.12, 0.2, 0.3, 0.45}) {
        sim::Random random(7);
        const Pose2 here{0.0, 0.2, 0.3};
        const Pose2 there{1.0, -0.2, 2.0};
        const auto before = standing_capture(room_of(40.0, 1.0, {{2.0, -1.0, 3.0, -0.4}}), here, 20, random);
        const auto after =
            standing_capture(room_of(40.0, 1.0, {{2.0 + moved, -1.0, 3.0 + moved, -0.4}}), there, 20, random);
        EXPECT_NE(align({.points = before}, {.points = after})->certainty, Certainty::kClear) << moved << " m";
    }
}

/// The legs of an L are similar: a robot in one leg may match the other leg.
TEST(AlignmentTrials, IsClearOnlyIfCorrectInTheLegsOfAnL) {
    const auto world = sim::make_world("L",
                                       {{-2.0, -2.0, 16.0, -1.0},
                                        {15.0, -2.0, 16.0, 2.0},
                                        {1.0, 1.0, 16.0, 16.0},
                                        {-2.0, 15.0, 1.0, 16.0},
                                        {-2.0, -2.0, -1.0, 16.0}},
                                       {{-1.0, -1.0, 15.0, 1.0}});
    int clear = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        sim::Random random(seed);
        const bool is_same_leg = seed % 2 == 0;
        const double along = is_same_leg ? 0.3 * static_cast<double>(seed) : 0.04 * static_cast<double>(seed);
        const Pose2 first{along, 0.3, 0.1 * static_cast<double>(seed)};
        const Pose2 second = is_same_leg ? Pose2{along + 2.0, -0.4, 2.0} : Pose2{-0.2, along, 1.0};
        const TwoCaptures captures{standing_capture(world, first, 20, random),
                                   standing_capture(world, second, 20, random), compose(inverse(first), second)};
        const auto alignment = aligned(captures);
        if (alignment.certainty != Certainty::kClear) continue;
        ++clear;
        const Pose2& found = alignment.T_first_second;
        EXPECT_TRUE(off(found, captures.T_first_second).is_right())
            << "seed " << seed << ": (" << found.x << ", " << found.y << "), " << found.yaw / kDegree << " degrees";
    }
    EXPECT_GE(clear, 10);
}

TEST(Alignment, IsAmbiguousAlongALongCorridor) {
    const auto captures = captures_at(room_of(40.0, 1.0), {0.0, 0.2, 0.3}, {1.0, -0.2, 2.0});
    const auto alignment = aligned(captures);
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
    EXPECT_NE(alignment.why, "");
    ASSERT_TRUE(alignment.competing_pose);
    const Pose2 T_map_first{0.0, 0.2, 0.3};
    const Pose2 one = compose(T_map_first, alignment.T_first_second);
    EXPECT_NEAR(std::abs(one.y), 0.2, 0.02)
        << "the position across the corridor is determined except for a rotation by half a turn";
    EXPECT_GT(off(alignment.T_first_second, *alignment.competing_pose).metres, kDistinctDistance);
}

TEST(Alignment, IsNotClearBetweenParallelLines) {
    std::vector<Point2> lines;
    for (int n = -80; n <= 80; ++n) {
        lines.push_back({0.1 * n, 1.0});
        lines.push_back({0.1 * n + 0.05, 1.0});
        lines.push_back({0.1 * n, -1.3});
        lines.push_back({0.1 * n + 0.05, -1.3});
    }
    const auto alignment = align({.points = lines}, {.points = lines}).value();
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
    EXPECT_THAT(alignment.why, HasSubstr("is not determined, as in a corridor"));
    EXPECT_GT(alignment.position_sigma, 0.0);
}

TEST(Alignment, IsAmbiguousAmongEvenlySpacedDoorFrames) {
    std::vector<Box> frames;
    for (double x = -39.0; x < 39.0; x += 1.5) frames.push_back({x, 0.9, x + 0.4, 1.0});
    const auto alignment = aligned(captures_at(room_of(40.0, 1.0, frames), {0.0, 0.2, 0.3}, {1.0, -0.2, 2.0}));
    EXPECT_EQ(alignment.certainty, Certainty::kAmbiguous);
}

TEST(Alignment, IsUndeterminedIfOnlyDistantSurfacesOverlap) {
    const auto hall = sim::make_hall();
    const auto alignment = aligned(two_captures(hall, doors_of(hall), 10'987));
    EXPECT_EQ(alignment.certainty, Certainty::kUndetermined);
    EXPECT_THAT(alignment.why, HasSubstr("is uncertain by"));
}

TEST(Alignment, IsUndeterminedForDifferentPlaces) {
    const auto room = sim::make_room();
    const auto hall = sim::make_hall();
    sim::Random random(1);
    const auto first = standing_capture(room, {-3.3, 1.2, 1.0}, 20, random);
    const auto second = standing_capture(hall, {12.0, 0.0, 0.0}, 20, random);
    const auto alignment = align({.points = first}, {.points = second}).value();
    EXPECT_EQ(alignment.certainty, Certainty::kUndetermined) << alignment.why;
    EXPECT_NE(alignment.why, "");
}

TEST(Alignment, IsDeterministicAndIndependentOfFrames) {
    const auto captures = two_captures(sim::make_room(), {}, 5);
    const auto once = aligned(captures);
    const auto again = aligned(captures);
    EXPECT_EQ(once.T_first_second, again.T_first_second);
    EXPECT_EQ(once.rms, again.rms);
    const Pose2 T_map_first{30.0, -20.0, 0.5};
    const Pose2 T_odom_second{-7.0, 3.0, -2.0};
    TwoCaptures moved = captures;
    for (Point2& point : moved.first) point = transform(T_map_first, point);
    for (Point2& point : moved.second) point = transform(T_odom_second, point);
    const auto elsewhere =
        align({moved.first, {T_map_first.x, T_map_first.y}}, {moved.second, {T_odom_second.x, T_odom_second.y}})
            .value();
    EXPECT_EQ(elsewhere.certainty, Certainty::kClear);
    const Pose2 expected = compose(compose(T_map_first, once.T_first_second), inverse(T_odom_second));
    const Off difference = off(elsewhere.T_first_second, expected);
    EXPECT_LT(difference.metres, 0.02) << "surface elements depend on the frame";
    EXPECT_LT(difference.radians, 0.2 * kDegree);
}

TEST(Alignment, IsNotClearForDegeneratePoints) {
    std::vector<Point2> wall;
    for (int n = 0; n < 400; ++n) wall.push_back({-2.0 + 0.01 * n, 1.5});
    const std::vector<Point2> heap(100, Point2{1.0, 1.0});
    std::vector<Point2> circle;
    for (int n = 0; n < 720; ++n) circle.push_back({3.0 * std::cos(n * kDegree / 2), 3.0 * std::sin(n * kDegree / 2)});
    for (const auto& points : {wall, heap, circle}) {
        const auto alignment = align({.points = points}, {.points = points}).value();
        EXPECT_NE(alignment.certainty, Certainty::kClear);
        EXPECT_NE(alignment.why, "");
        EXPECT_TRUE(is_finite(alignment.T_first_second));
        EXPECT_TRUE(std::isfinite(alignment.position_sigma) && std::isfinite(alignment.yaw_sigma));
    }
    EXPECT_NE(align({.points = wall}, {.points = heap})->certainty, Certainty::kClear);
}

TEST(Alignment, IsClearForOneTurnOfTheLidar) {
    const auto captures = two_captures(sim::make_room(), {}, 3, 1);
    const auto alignment = aligned(captures);
    const Off error = off(alignment.T_first_second, captures.T_first_second);
    EXPECT_EQ(alignment.certainty, Certainty::kClear) << alignment.why;
    EXPECT_TRUE(error.metres < 0.03 && error.radians < kDegree) << error.metres;
}

TEST(Alignment, RefusesInvalidPoints) {
    const std::vector<Point2> good(20, Point2{1.0, 1.0});
    EXPECT_THAT(align({.points = {}}, {.points = good}).error().message, HasSubstr("first has 0 points"));
    EXPECT_THAT(align({.points = good}, {.points = std::span(good).first(19)}).error().message,
                HasSubstr("second has 19 points"));
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        auto points = good;
        points[7].y = bad;
        EXPECT_THAT(align({.points = points}, {.points = good}).error().message, HasSubstr("first.points[7]"));
        EXPECT_THAT(align({.points = good}, {good, {bad, 0.0}}).error().message, HasSubstr("second.from"));
        EXPECT_THAT(align({.points = good}, {.points = good}, {.distance_max = bad}).error().message,
                    HasSubstr("distance_max"));
    }
    EXPECT_FALSE(align({.points = good}, {.points = good}, {.distance_max = 0.0}));
}

} // namespace
} // namespace scanloom::landmarks

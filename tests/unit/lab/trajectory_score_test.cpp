#include "lab/trajectory_score.hpp"

#include "tests/support/temporary_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

namespace scanloom::lab {
namespace {

using robot::StampedPose;
using testing::HasSubstr;

constexpr double kQuarterTurn = std::numbers::pi / 2.0;

Result<std::vector<Relation>> read(std::string_view text) {
    const TemporaryDirectory place;
    const auto path = place.path() / "a.relations";
    std::ofstream(path, std::ios::binary) << text;
    return read_relations(path);
}

TEST(Relations, AreReadWithoutCommentsAndBlankLines) {
    const auto relations = read("# t1 t2 x y z roll pitch yaw\n\n1.5 2.5 0.5 -0.25 9 9 9 7.0\r\n3 2 1 0 0 0 0 -1e-1\n");
    ASSERT_TRUE(relations) << relations.error().message;
    ASSERT_EQ(relations->size(), 2U);
    const Relation& first = relations->front();
    EXPECT_EQ(first.from_stamp, 1.5);
    EXPECT_EQ(first.to_stamp, 2.5);
    EXPECT_EQ(first.T_from_to.x, 0.5);
    EXPECT_EQ(first.T_from_to.y, -0.25);
    EXPECT_NEAR(first.T_from_to.yaw, 7.0 - 2.0 * std::numbers::pi, 1e-12);
    EXPECT_EQ(relations->back().T_from_to, (Pose2{1, 0, -0.1}));
}

TEST(Relations, InvalidLineIsAnErrorWithItsNumber) {
    EXPECT_THAT(read("# a\n1 2 0 0 0 0 0 0\n1 2 0 0 0 0 0\n").error().message,
                HasSubstr("a.relations:3: 7 values; 8 are needed"));
    EXPECT_THAT(read("1 2 0 x 0 0 0 0\n").error().message, HasSubstr("a.relations:1: "));
    EXPECT_EQ(read("1 2 0 inf 0 0 0 0\n").error().code, Errc::kInvalidField);
    EXPECT_EQ(read("1 2 0 0 0 0 0 0 0\n").error().code, Errc::kMalformed);
}

TEST(Relations, FileWithoutRelationsIsAnError) {
    EXPECT_EQ(read("# only\n").error().code, Errc::kNotFound);
    EXPECT_THAT(read("").error().message, HasSubstr("a.relations: no relation"));
    EXPECT_EQ(read_relations("/nonexistent/a.relations").error().code, Errc::kNotFound);
}

/// Returns a robot that drives 1 m/s along x, turns left on the spot from 2 s to 3 s, and drives on along y.
std::vector<StampedPose> square_corner() {
    return {{{4, 0, 0}, 0}, {{5, 0, 0}, 1}, {{6, 0, 0}, 2}, {{6, 0, kQuarterTurn}, 3}, {{6, 1, kQuarterTurn}, 4}};
}

TEST(TrajectoryScore, IsZeroForExactRelations) {
    const std::vector<Relation> relations{
        {0, 2, {2, 0, 0}}, {1, 4, {1, 1, kQuarterTurn}}, {4, 1, {-1, 1, -kQuarterTurn}}, {0.25, 1.5, {1.25, 0, 0}}};
    const auto score = score_trajectory(square_corner(), relations, RelationUse::kInterpolated);
    ASSERT_TRUE(score) << score.error().message;
    EXPECT_EQ(score->used, 4U);
    EXPECT_EQ(score->missing, 0U);
    EXPECT_NEAR(score->translation.absolute.mean, 0.0, 1e-12);
    EXPECT_NEAR(score->rotation.absolute.mean, 0.0, 1e-12);
}

TEST(TrajectoryScore, HasMeanAndDeviationOfErrorsAndOfTheirSquares) {
    // Translations are wrong by 0.5 m (3-4-5), 0.1 m and 0.
    const std::vector<Relation> shifted{{0, 1, {1.3, 0.4, 0}}, {1, 2, {0.9, 0, 0}}, {2, 4, {0, 1, kQuarterTurn}}};
    const auto score = score_trajectory(square_corner(), shifted, RelationUse::kInterpolated);
    ASSERT_TRUE(score);
    EXPECT_NEAR(score->translation.absolute.mean, 0.2, 1e-12);
    EXPECT_NEAR(score->translation.absolute.deviation, 0.264575131, 1e-9) << "sqrt((0.09 + 0.01 + 0.04) / 2)";
    EXPECT_NEAR(score->translation.squared.mean, 0.26 / 3.0, 1e-12);
    EXPECT_NEAR(score->translation.squared.deviation, 0.141539159, 1e-9);
    EXPECT_NEAR(score->rotation.absolute.mean, 0.0, 1e-9);

    // On the spot, yaws are wrong by 0, 10 and 20 degrees.
    const double degree = std::numbers::pi / 180.0;
    const std::vector<Relation> turned{{2, 3, {0, 0, kQuarterTurn}},
                                       {2, 3, {0, 0, kQuarterTurn + 10 * degree}},
                                       {3, 2, {0, 0, -kQuarterTurn - 20 * degree}}};
    const auto turns = score_trajectory(square_corner(), turned, RelationUse::kInterpolated);
    ASSERT_TRUE(turns);
    EXPECT_NEAR(turns->rotation.absolute.mean, 10.0, 1e-9);
    EXPECT_NEAR(turns->rotation.absolute.deviation, 10.0, 1e-9);
    EXPECT_NEAR(turns->rotation.squared.mean, 500.0 / 3.0, 1e-6);
    EXPECT_NEAR(turns->translation.absolute.mean, 0.0, 1e-12);
}

TEST(TrajectoryScore, YawErrorTurnsTheTranslationOfTheRelation) {
    // The relation's 1 m is turned by the yaw error of a quarter: an error of sqrt(2) m.
    const std::vector<Relation> relations{{0, 1, {1, 0, -kQuarterTurn}}};
    const auto score = score_trajectory(square_corner(), relations, RelationUse::kInterpolated);
    ASSERT_TRUE(score);
    EXPECT_NEAR(score->translation.absolute.mean, std::numbers::sqrt2, 1e-12);
    EXPECT_NEAR(score->rotation.absolute.mean, 90.0, 1e-9);
}

TEST(TrajectoryScore, RotationErrorAcrossHalfATurnIsSmall) {
    const std::vector<StampedPose> trajectory{{{0, 0, 3.1}, 0}, {{0, 0, -3.1}, 1}};
    const std::vector<Relation> relations{{0, 1, {0, 0, 0}}, {0, 0.5, {0, 0, 0}}};
    const auto score = score_trajectory(trajectory, relations, RelationUse::kInterpolated);
    ASSERT_TRUE(score);
    const double whole_deg = (2.0 * std::numbers::pi - 6.2) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(score->rotation.absolute.mean, 0.75 * whole_deg, 1e-9);
}

TEST(TrajectoryScore, OrderOfPosesDoesNotMatter) {
    auto shuffled = square_corner();
    std::swap(shuffled[0], shuffled[3]);
    const std::vector<Relation> relations{{0, 2, {2, 0, 0}}, {1, 4, {1, 1, kQuarterTurn}}};
    const auto score = score_trajectory(shuffled, relations, RelationUse::kInterpolated);
    ASSERT_TRUE(score);
    EXPECT_NEAR(score->translation.absolute.mean, 0.0, 1e-12);
}

TEST(TrajectoryScore, RelationsOutsideTheTrajectoryAreMissing) {
    const std::vector<Relation> relations{
        {-0.5, 1, {1, 0, 0}}, {1, 4.5, {1, 1, kQuarterTurn}}, {-0.51, 1, {1, 0, 0}}, {1, 4.51, {1, 1, kQuarterTurn}}};
    const auto score = score_trajectory(square_corner(), relations, RelationUse::kInterpolated);
    ASSERT_TRUE(score);
    EXPECT_EQ(score->used, 2U);
    EXPECT_EQ(score->missing, 2U);
    EXPECT_NEAR(score->translation.absolute.mean, 0.0, 1e-12);
}

TEST(TrajectoryScore, RelationsOfDroppedScansAreLeftOut) {
    const std::vector<Relation> relations{
        {0.0009, 1.9991, {2, 0, 0}}, {0, 1.5, {1.5, 0, 0}}, {2.5, 4, {0, 1, 0}}, {-0.4, 1, {1, 0, 0}}, {9, 1, {}}};
    const auto of_scans = score_trajectory(square_corner(), relations, RelationUse::kOfScans);
    ASSERT_TRUE(of_scans);
    EXPECT_EQ(of_scans->used, 1U);
    EXPECT_EQ(of_scans->left_out, 3U);
    EXPECT_EQ(of_scans->missing, 1U);
    EXPECT_EQ(score_trajectory(square_corner(), relations, RelationUse::kInterpolated)->used, 4U);
    EXPECT_EQ(score_trajectory(square_corner(), relations, RelationUse::kInterpolated)->left_out, 0U);
}

TEST(TrajectoryScore, RelationsOfAnotherLogAreAnError) {
    const std::vector<Relation> relations{{100, 101, {1, 0, 0}}};
    for (const auto& trajectory : {square_corner(), std::vector<StampedPose>{}}) {
        const auto score = score_trajectory(trajectory, relations, RelationUse::kInterpolated);
        ASSERT_FALSE(score);
        EXPECT_THAT(score.error().message, HasSubstr("no relation of 1 can be used"));
    }
}

} // namespace
} // namespace scanloom::lab

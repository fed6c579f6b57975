#include "tests/unit/lab/drawn_grids.hpp"

#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

const Rows kGroundTruth{"##########", //
                        "#........#", //
                        "#........#", //
                        "#........#", //
                        "#........#", //
                        "##########"};
const Rows kAll(6, "xxxxxxxxxx");
const Rows kNone(6, "          ");

Scores scores_of(const Rows& map, const Rows& seen = kAll, const Rows& walked = kNone) {
    return score(map_of(map), truth_cells_of(kGroundTruth), mask_of(seen), mask_of(walked));
}

TEST(Scoring, GroundTruthMapScoresOne) { EXPECT_EQ(scores_of(kGroundTruth), (Scores{1.0, 1.0, 1.0, 1.0, 1.0, 28, 0})); }

TEST(Scoring, EmptyMapScoresZero) { EXPECT_EQ(scores_of(kNone), (Scores{0, 0, 0, 0, 0, 0, 0})); }

TEST(Scoring, InvertedMapMatchesOnlyNearBorders) {
    const auto scores = scores_of({"..........", //
                                   ".########.", //
                                   ".########.", //
                                   ".########.", //
                                   ".########.", //
                                   ".........."});
    EXPECT_DOUBLE_EQ(scores.precision, 20.0 / 32.0);
    EXPECT_EQ(scores.iou_exact, 0.0);
    EXPECT_EQ(scores.free_recall, 0.0);
}

TEST(Scoring, AdjacentCellMatchesWithinToleranceButNotExactly) {
    const auto scores = scores_of({"          ", //
                                   " ######## ", //
                                   " #......# ", //
                                   " #......# ", //
                                   " ######## ", //
                                   "          "});
    EXPECT_EQ(scores.precision, 1.0);
    EXPECT_EQ(scores.recall, 1.0);
    EXPECT_EQ(scores.iou, 1.0);
    EXPECT_EQ(scores.iou_exact, 0.0);
    EXPECT_EQ(scores.free_recall, 1.0) << "cells next to a wall are not required";
}

TEST(Scoring, CellsFarFromSolidsReducePrecision) {
    Rows map = kGroundTruth;
    map[2] = "#..##....#";
    const auto scores = scores_of(map);
    EXPECT_DOUBLE_EQ(scores.precision, 28.0 / 30.0);
    EXPECT_EQ(scores.recall, 1.0);
    EXPECT_DOUBLE_EQ(scores.iou, 28.0 / 30.0);
    EXPECT_DOUBLE_EQ(scores.iou_exact, 28.0 / 30.0);
    EXPECT_DOUBLE_EQ(scores.free_recall, 10.0 / 12.0);
    EXPECT_EQ(scores.occupied, 30U);
    EXPECT_EQ(scores.residue, 0U) << "no walker was there";
}

TEST(Scoring, ExcludesUnobservableCellsInsideSolids) {
    const Rows truth{"       ", "       ", "#######", "#######", "#######"};
    const Rows seen{"xxxxxxx", "xxxxxxx", "xxxxxxx", "       ", "       "};
    const Rows walked(5, "       ");
    const auto scores_with = [&](const char* surface, const char* inside) {
        return score(map_of({"       ", "   #   ", surface, inside, "       "}), truth_cells_of(truth), mask_of(seen),
                     mask_of(walked));
    };
    EXPECT_DOUBLE_EQ(scores_with("###    ", "       ").iou_exact, 3.0 / 8.0);
    EXPECT_DOUBLE_EQ(scores_with("###    ", "#######").iou_exact, 3.0 / 8.0);
}

TEST(Scoring, IouDoesNotExceedPrecisionOrRecall) {
    Rows map = kGroundTruth;
    map[2] = "#..##....#";
    map[5] = "          ";
    const auto scores = scores_of(map);
    EXPECT_LT(scores.recall, 1.0);
    EXPECT_LT(scores.precision, 1.0);
    EXPECT_DOUBLE_EQ(1.0 / scores.iou, 1.0 / scores.precision + 1.0 / scores.recall - 1.0);
    EXPECT_LT(scores.iou, std::min(scores.precision, scores.recall));
}

TEST(Scoring, ResidueCountsOccupiedCellsOnAWalkersTrack) {
    Rows map = kGroundTruth;
    map[2] = "#..##.#..#";
    Rows walked = kNone;
    walked[2] = "xxxx      "; // beyond the wall, which is not residue
    EXPECT_EQ(scores_of(map, kAll, walked).residue, 1U);
}

TEST(Scoring, RecallCountsOnlyVisibleCells) {
    Rows seen = kNone;
    seen[5] = "xxxxx     ";
    seen[3] = "xxxx      ";
    const auto scores = scores_of({"          ", //
                                   "          ", //
                                   "          ", //
                                   "  ..      ", //
                                   "          ", //
                                   "##        "},
                                  seen);
    EXPECT_EQ(scores.precision, 1.0);
    EXPECT_DOUBLE_EQ(scores.recall, 3.0 / 6.0) << "three of five cells below and none on the left";
    EXPECT_DOUBLE_EQ(scores.iou, 0.5);
    EXPECT_DOUBLE_EQ(scores.iou_exact, 2.0 / 6.0);
    EXPECT_DOUBLE_EQ(scores.free_recall, 2.0 / 2.0);
}

TEST(Scoring, WallsOutsideTheRoomReducePrecision) {
    const Rows truth{"      ", "      ", "      ", "###   "};
    const Rows map{"   ## ", "      ", "      ", "###   "};
    const Rows none(4, "      ");
    const auto scores = score(map_of(map), truth_cells_of(truth), mask_of(none), mask_of(none));
    EXPECT_DOUBLE_EQ(scores.precision, 3.0 / 5.0);
}

} // namespace
} // namespace scanloom::lab

#include "sim/ground_truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace scanloom::sim {
namespace {

/// Draws the grid, rows from the top: '#' occupied, '.' free, ' ' outside.
std::string drawn(const GroundTruthGrid& grid) {
    std::string text;
    for (std::int32_t j = grid.j_begin + grid.height - 1; j >= grid.j_begin; --j) {
        for (std::int32_t i = grid.i_begin; i < grid.i_begin + grid.width; ++i) {
            text += grid.at(i, j) == GroundTruth::kOccupied ? '#' : grid.at(i, j) == GroundTruth::kFree ? '.' : ' ';
        }
        text += '\n';
    }
    return text;
}

/// Returns a closet of 1 x 1 m with walls of 0.2 m and a box whose upper side lies inside a cell.
World closet() {
    return make_world("closet",
                      {{-0.2, -0.2, 1.2, 0.0},
                       {-0.2, 1.0, 1.2, 1.2},
                       {-0.2, -0.2, 0.0, 1.2},
                       {1.0, -0.2, 1.2, 1.2},
                       {0.2, 0.0, 0.6, 0.25}},
                      {{0.0, 0.0, 1.0, 1.0}});
}

TEST(GroundTruthGrid, RoundingMarksNoAdjacentCell) {
    const auto tenths = ground_truth_of(make_world("", {{0.0, 0.0, 1.1, 0.3}}, {}), 0.1); // 1.1 * 10 > 11
    EXPECT_EQ(tenths.width, 11);
    EXPECT_EQ(tenths.height, 3);
    const auto hundredths = ground_truth_of(make_world("", {{0.29, 0.0, 0.57, 0.07}}, {}), 0.01); // 0.29 * 100 < 29
    EXPECT_EQ(hundredths.i_begin, 29);
    EXPECT_EQ(hundredths.width, 28);
    EXPECT_EQ(hundredths.height, 7);
}

TEST(GroundTruthGrid, UnreachableCellsAreOutside) {
    World world = closet();
    world.solids.push_back({0.0, 0.6, 1.0, 0.8});
    world.floors = {{0.0, 0.0, 1.0, 0.6}};
    EXPECT_EQ(drawn(ground_truth_of(world, 0.2)), "#######\n"
                                                  "#     #\n"
                                                  "#######\n"
                                                  "#.....#\n"
                                                  "#.##..#\n"
                                                  "#.##..#\n"
                                                  "#######\n");
    EXPECT_EQ(ground_truth_of(world, 0.2).at(-2, 3), GroundTruth::kOutside);
    EXPECT_EQ(ground_truth_of(world, 0.2).at(1000, 0), GroundTruth::kOutside);
}

TEST(GroundTruthGrid, WalkersAreExcluded) {
    EXPECT_EQ(ground_truth_of(make_room_walker(), 0.1).cells, ground_truth_of(make_room(), 0.1).cells);
}

class TruthGrids : public testing::TestWithParam<double> {};

TEST_P(TruthGrids, MatchTheSolidsInEveryCellOfTheOffice) {
    const World office = make_office();
    const double size = GetParam();
    const auto grid = ground_truth_of(office, size);
    for (std::int32_t j = grid.j_begin - 1; j <= grid.j_begin + grid.height; ++j) {
        for (std::int32_t i = grid.i_begin - 1; i <= grid.i_begin + grid.width; ++i) {
            const double x = i * size;
            const double y = j * size;
            const bool is_touched = std::ranges::any_of(office.solids, [&](const Box& box) {
                return box.x_min < x + size - 1e-7 && box.x_max > x + 1e-7 && box.y_min < y + size - 1e-7 &&
                       box.y_max > y + 1e-7;
            });
            const bool is_indoors = std::abs(x + size / 2) < 15.0 && std::abs(y + size / 2) < 10.0;
            const GroundTruth wanted = is_touched   ? GroundTruth::kOccupied
                                       : is_indoors ? GroundTruth::kFree
                                                    : GroundTruth::kOutside;
            ASSERT_EQ(grid.at(i, j), wanted) << x << ' ' << y;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(CellSizes, TruthGrids, testing::Values(0.05, 0.1, 0.25, 0.5, 1.0));

} // namespace
} // namespace scanloom::sim

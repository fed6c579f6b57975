#include "server/mapping/cell.hpp"

#include <gtest/gtest.h>

#include <random>

namespace scanloom::mapping {
namespace {

TEST(GridGeometry, WorkedExamplesAtTenCellsPerMetre) {
    const GridGeometry grid(0.1);
    EXPECT_EQ(grid.cell_at({0.0, 0.0}), (Cell{0, 0}));
    EXPECT_EQ(grid.cell_at({1.0, -2.0}), (Cell{10, -20}));
    EXPECT_EQ(grid.cell_at({0.30, 0.50}), (Cell{3, 5}));
    EXPECT_EQ(grid.cell_at({0.33, 0.57}), (Cell{3, 5}));
}

TEST(GridGeometry, CellToCentreToCellIsTheIdentity) {
    std::mt19937 random(5);
    std::uniform_int_distribution<std::int32_t> index(-1'000'000, 1'000'000);
    for (const double cell_size : {0.01, 0.02, 0.03, 0.05, 0.1, 0.25, 0.3, 0.5, 0.7, 1.0}) {
        const GridGeometry grid(cell_size);
        for (int n = 0; n < 20'000; ++n) {
            const Cell cell{index(random), index(random)};
            ASSERT_EQ(grid.cell_at(grid.centre_of(cell)), cell) << "cell size " << cell_size;
        }
    }
}

TEST(CellBox, GrowsToHoldWhatItIsGiven) {
    CellBox box;
    EXPECT_TRUE(box.empty());
    box.include_row(-3, 5, 9);
    box.include_row(2, -1, 0);
    EXPECT_EQ(box, (CellBox{-1, -3, 9, 3}));
    EXPECT_EQ(box.width(), 10);
    EXPECT_EQ(box.height(), 6);
    CellBox other;
    other.include(box);
    EXPECT_EQ(other, box);
}

} // namespace
} // namespace scanloom::mapping

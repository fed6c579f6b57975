#include "server/tiles/extent.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace scanloom::tiles {
namespace {

using grid::CellBox;

TEST(Extent, OfTheTilesIsTheSquareOf131072Cells) {
    EXPECT_EQ(tiled_extent(0.05), (Extent{-3276.8, -3276.8, 3276.8, 3276.8}));
}

TEST(Extent, CellsToMetresAndBackIsTheIdentityAtEveryCellSize) {
    for (const double cell_size : {0.01, 0.03, 0.05, 0.07, 0.1, 0.5, 1.0}) {
        for (std::int32_t i = -100'000; i < 100'000; i += 317) {
            const CellBox box{i, i / 2, i + 1 + std::abs(i) % 7, i / 2 + 3};
            ASSERT_EQ(cells_in(extent_of(box, cell_size), cell_size).value(), box) << cell_size;
        }
    }
}

TEST(Extent, HoldsEveryCellThatItOverlaps) {
    EXPECT_EQ(cells_in({-0.05, 0.31, 0.05, 0.49}, 0.1).value(), (CellBox{-1, 3, 1, 5}));
    EXPECT_EQ(cells_in({0.3, 0.3, 0.7, 0.7}, 0.1).value(), (CellBox{3, 3, 7, 7})) << "decimal metres";
    EXPECT_EQ(cells_in({0.31, 0.31, 0.32, 0.32}, 0.1).value(), (CellBox{3, 3, 4, 4})) << "within one cell";
    const double border = 0.3;
    EXPECT_EQ(cells_in({border, border, std::nextafter(border, 1.0), 0.4}, 0.1)->width(), 1);
}

TEST(Extent, RectanglesThatNameNoCellsAreRefused) {
    const double nan = std::nan("");
    for (const Extent& bad : {Extent{0, 0, 0, 1}, Extent{0, 0, 1, 0}, Extent{1, 0, 0, 1}, Extent{0, 1, 1, 0},
                              Extent{nan, 0, 1, 1}, Extent{0, 0, 1, nan}, Extent{-HUGE_VAL, 0, 1, 1},
                              Extent{0, 0, 1, HUGE_VAL}, Extent{0, 0, 1e300, 1}, Extent{-6e7, 0, 1, 1}}) {
        const auto cells = cells_in(bad, 0.05);
        ASSERT_FALSE(cells);
        EXPECT_EQ(cells.error().code, Errc::kInvalidField);
        EXPECT_THAT(cells.error().message, testing::StartsWith("bbox"));
    }
}

} // namespace
} // namespace scanloom::tiles

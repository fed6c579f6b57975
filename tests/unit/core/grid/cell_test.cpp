#include "core/grid/cell.hpp"

#include <gtest/gtest.h>

namespace scanloom::grid {
namespace {

TEST(CellBox, GrowsToIncludeAddedRows) {
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
} // namespace scanloom::grid

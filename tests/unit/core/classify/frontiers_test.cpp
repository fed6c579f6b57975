#include "core/classify/frontiers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <set>

namespace scanloom::classify {
namespace {

using grid::Cell;

struct ByRows {
    bool operator()(Cell a, Cell b) const { return a.j != b.j ? a.j < b.j : a.i < b.i; }
};
using Cells = std::set<Cell, ByRows>;

ClassView view_of(const Cells& frontier_cells) {
    ClassChunk blank;
    blank.cells.fill(CellClass::kUnexplored);
    grid::ChunkTree<ClassChunk> tree(std::make_shared<const ClassChunk>(blank));
    for (const Cell cell : frontier_cells) tree.write(grid::chunk_of(cell), 1).at(cell) = CellClass::kFrontier;
    return tree.snapshot();
}

/// Finds the groups by a flood fill from cell to cell.
std::vector<std::vector<Cell>> groups_of(Cells left) {
    std::vector<std::vector<Cell>> groups;
    while (!left.empty()) {
        std::vector<Cell> group = {*left.begin()};
        left.erase(left.begin());
        for (std::size_t next = 0; next < group.size(); ++next) {
            for (int dj = -1; dj <= 1; ++dj) {
                for (int di = -1; di <= 1; ++di) {
                    const Cell neighbor{group[next].i + di, group[next].j + dj};
                    if (left.erase(neighbor) > 0) group.push_back(neighbor);
                }
            }
        }
        std::ranges::sort(group, ByRows{});
        groups.push_back(std::move(group));
    }
    std::ranges::stable_sort(groups, std::greater{}, [](const auto& group) { return group.size(); });
    return groups;
}

TEST(Frontiers, AreConnectedComponents) {
    std::mt19937 random(11);
    for (int round = 0; round < 60; ++round) {
        Cells cells;
        const auto reach = 20 + random() % 120;
        const auto count = random() % (reach * reach);
        for (std::size_t n = 0; n < count; ++n) {
            cells.insert({static_cast<int>(random() % (2 * reach)) - static_cast<int>(reach),
                          static_cast<int>(random() % (2 * reach)) - static_cast<int>(reach)});
        }
        const std::size_t size_min = random() % 4;
        const auto frontiers = find_frontiers(view_of(cells), size_min);
        auto expected = groups_of(cells);
        std::erase_if(expected, [&](const auto& group) { return group.size() < size_min; });
        ASSERT_EQ(frontiers.size(), expected.size());
        for (std::size_t f = 0; f < expected.size(); ++f) ASSERT_EQ(frontiers[f].cells, expected[f]);
    }
}

TEST(Frontiers, AreConnectedComponentsOfTheCellsThatAreNotExcluded) {
    std::mt19937 random(12);
    for (int round = 0; round < 60; ++round) {
        const int reach = 5 + static_cast<int>(random() % 70);
        const auto anywhere = [&] {
            return Cell{static_cast<int>(random()) % reach, static_cast<int>(random()) % reach};
        };
        Cells cells;
        for (int n = 0; n < reach * reach; ++n) cells.insert(anywhere());
        std::vector<Cell> without;
        Cells left = cells;
        for (int n = 0; n < reach * reach / 3; ++n) {
            without.push_back(anywhere()); // some cells occur more than once, some are not frontier cells
            left.erase(without.back());
        }
        const auto frontiers = find_frontiers(view_of(cells), 2, without);
        auto expected = groups_of(left);
        std::erase_if(expected, [](const auto& group) { return group.size() < 2; });
        ASSERT_EQ(frontiers.size(), expected.size());
        for (std::size_t f = 0; f < expected.size(); ++f) ASSERT_EQ(frontiers[f].cells, expected[f]);
    }
}

TEST(Frontiers, HaveCentroidAndBoundsOfTheirCells) {
    const auto frontiers = find_frontiers(view_of({{-3, -1}, {-2, 0}, {-1, 0}, {0, 1}, {0, 2}}));
    ASSERT_EQ(frontiers.size(), 1U);
    EXPECT_EQ(frontiers[0].bounds, (grid::CellBox{-3, -1, 1, 3}));
    EXPECT_DOUBLE_EQ(frontiers[0].centroid_x, (-2.5 - 1.5 - 0.5 + 0.5 + 0.5) / 5.0);
    EXPECT_DOUBLE_EQ(frontiers[0].centroid_y, (-0.5 + 0.5 + 0.5 + 1.5 + 2.5) / 5.0);
}

TEST(Frontiers, AreLeftOutIfSmall) {
    const Cells cells = {{0, 0}, {1, 0}, {2, 0}, {10, 0}, {11, 0}, {20, 0}};
    EXPECT_EQ(find_frontiers(view_of(cells), 2).size(), 2U);
    EXPECT_EQ(find_frontiers(view_of(cells), 3).size(), 1U);
    EXPECT_TRUE(find_frontiers(view_of(cells), 4).empty());
    EXPECT_TRUE(find_frontiers(ClassView{}).empty());
}

TEST(Frontiers, IgnoreChunksOutsideTheCellRange) {
    ClassChunk frontier;
    frontier.cells.fill(CellClass::kFrontier);
    grid::ChunkTree<ClassChunk> tree(std::make_shared<const ClassChunk>(frontier));
    (void)tree.write({std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()}, 1);
    (void)tree.write({1 << 25, 0}, 1);
    (void)tree.write({0, (1 << 25) - 1}, 1);
    EXPECT_TRUE(find_frontiers(tree.snapshot()).empty());
    (void)tree.write({(1 << 25) - 2, 2 - (1 << 25)}, 1);
    EXPECT_EQ(find_frontiers(tree.snapshot()).size(), 1U);
}

} // namespace
} // namespace scanloom::classify

#include "core/planning/bit_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>

namespace scanloom::planning {
namespace {

BitGrid random_grid(std::mt19937& random, std::int32_t width, std::int32_t height, int set_in_100) {
    BitGrid grid(width, height);
    for (std::int32_t y = 0; y < height; ++y) {
        for (std::int32_t x = 0; x < width; ++x) {
            if (static_cast<int>(random() % 100) < set_in_100) grid.set({x, y});
        }
    }
    return grid;
}

template <class Visit>
void for_each_spot(const BitGrid& grid, Visit visit) {
    for (std::int32_t y = 0; y < grid.height(); ++y) {
        for (std::int32_t x = 0; x < grid.width(); ++x) visit(Spot{x, y});
    }
}

TEST(BitGrid, NeighboursOutsideTheGridAreClear) {
    std::mt19937 random(1);
    const BitGrid grid = random_grid(random, 128, 9, 50);
    for_each_spot(grid, [&](Spot at) {
        for (int place = 0; place < 9; ++place) {
            const Spot neighbor{at.x + place % 3 - 1, at.y + place / 3 - 1};
            const bool inside = neighbor.x >= 0 && neighbor.x < 128 && neighbor.y >= 0 && neighbor.y < 9;
            ASSERT_EQ((grid.around(at) >> place & 1) != 0, inside && grid.test(neighbor));
        }
    });
}

TEST(BitGrid, VisitsSetCellsInRowOrder) {
    std::mt19937 random(2);
    const BitGrid grid = random_grid(random, 192, 20, 30);
    std::vector<Spot> expected;
    for_each_spot(grid, [&](Spot at) {
        if (grid.test(at)) expected.push_back(at);
    });
    std::vector<Spot> visited;
    for_each_set(grid, [&](Spot at) { visited.push_back(at); });
    EXPECT_EQ(visited, expected);
    EXPECT_EQ(grid.count(), static_cast<std::int64_t>(expected.size()));
}

TEST(BitGrid, FindsNextSetAndNextClearCell) {
    std::mt19937 random(3);
    for (const int density : {2, 50, 98}) {
        const BitGrid grid = random_grid(random, 192, 4, density);
        for_each_spot(grid, [&](Spot at) {
            const auto find = [&](bool wanted) {
                std::int32_t x = at.x;
                while (x < 192 && grid.test({x, at.y}) != wanted) ++x;
                return x;
            };
            ASSERT_EQ(next_set(grid.row(at.y), at.x), find(true));
            ASSERT_EQ(next_clear(grid.row(at.y), at.x), find(false));
        });
    }
    EXPECT_EQ(next_set(random_grid(random, 64, 1, 100).row(0), 64), 64);
}

TEST(BitGrid, ConnectedMatchesFloodFill) {
    std::mt19937 random(4);
    for (int round = 0; round < 200; ++round) {
        const BitGrid grid = random_grid(random, 64 + 64 * (round % 3), 1 + round % 30, 40 + round % 60);
        const Spot seed{static_cast<std::int32_t>(random() % static_cast<unsigned>(grid.width())),
                        static_cast<std::int32_t>(random() % static_cast<unsigned>(grid.height()))};
        BitGrid expected(grid.width(), grid.height());
        std::deque<Spot> open;
        const auto reach = [&](Spot at) {
            if (!grid.test(at) || expected.test(at)) return;
            expected.set(at);
            open.push_back(at);
        };
        for (reach(seed); !open.empty(); open.pop_front()) {
            const Spot at = open.front();
            for (const Spot neighbor :
                 {Spot{at.x + 1, at.y}, Spot{at.x - 1, at.y}, Spot{at.x, at.y + 1}, Spot{at.x, at.y - 1}}) {
                reach(neighbor);
            }
        }
        ASSERT_EQ(connected(grid, seed), expected) << "round " << round;
    }
}

TEST(BitGrid, DilatedSetsExactlyCellsWithinHalfWidths) {
    std::mt19937 random(5);
    const std::vector<std::vector<std::int32_t>> shapes = {{0}, {1, 0}, {3, 3, 2, 1}, {70, 66, 2}, {5, 0, 0, 0, 0}};
    for (const auto& widths : shapes) {
        for (const int density : {1, 5}) {
            const BitGrid grid = random_grid(random, 192, 25, density);
            const BitGrid result = dilated(grid, widths);
            BitGrid expected(192, 25);
            for_each_set(grid, [&](Spot at) {
                const auto reach = static_cast<std::int32_t>(widths.size()) - 1;
                for (std::int32_t y = std::max(at.y - reach, 0); y <= std::min(at.y + reach, 24); ++y) {
                    const std::int32_t width = widths[static_cast<std::size_t>(std::abs(y - at.y))];
                    for (std::int32_t x = std::max(at.x - width, 0); x <= std::min(at.x + width, 191); ++x) {
                        expected.set({x, y});
                    }
                }
            });
            ASSERT_EQ(result, expected) << "first half width " << widths[0];
        }
    }
}

TEST(BitGrid, SupportsIntersectionUnionAndDifference) {
    std::mt19937 random(6);
    const BitGrid a = random_grid(random, 64, 7, 50);
    const BitGrid b = random_grid(random, 64, 7, 50);
    BitGrid both = a;
    both &= b;
    BitGrid either = a;
    either |= b;
    BitGrid only_a = a;
    only_a.subtract(b);
    for_each_spot(a, [&](Spot at) {
        EXPECT_EQ(both.test(at), a.test(at) && b.test(at));
        EXPECT_EQ(either.test(at), a.test(at) || b.test(at));
        EXPECT_EQ(only_a.test(at), a.test(at) && !b.test(at));
    });
    either.clear({3, 3});
    EXPECT_FALSE(either.test({3, 3}));
}

} // namespace
} // namespace scanloom::planning

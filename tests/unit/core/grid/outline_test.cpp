#include "core/grid/outline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <utility>

namespace scanloom::grid {
namespace {

using testing::ElementsAre;

TEST(Outline, RectangleHasFourCorners) {
    const auto outlines = outlines_of({{2, 1}, {3, 1}, {2, 2}, {3, 2}, {4, 1}, {4, 2}});
    ASSERT_EQ(outlines.size(), 1U);
    EXPECT_THAT(outlines[0], ElementsAre(Ring{{2, 1}, {5, 1}, {5, 3}, {2, 3}, {2, 1}}));
}

TEST(Outline, HoleFollowsTheOuterRingInOppositeDirection) {
    std::vector<Cell> cells;
    for (std::int32_t n = 0; n < 9; ++n) {
        if (n != 4) cells.push_back({n % 3, n / 3});
    }
    const auto outlines = outlines_of(cells);
    ASSERT_EQ(outlines.size(), 1U);
    EXPECT_THAT(outlines[0], ElementsAre(Ring{{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}},
                                         Ring{{2, 1}, {1, 1}, {1, 2}, {2, 2}, {2, 1}}));
}

TEST(Outline, CellsTouchingAtACornerAreTwoAreas) {
    const auto outlines = outlines_of({{1, 1}, {0, 0}});
    ASSERT_EQ(outlines.size(), 2U);
    EXPECT_THAT(outlines[0], ElementsAre(Ring{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}));
    EXPECT_THAT(outlines[1], ElementsAre(Ring{{1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}}));
}

TEST(Outline, HoleTouchingTheOutsideAtACornerIsAHole) {
    const auto outlines = outlines_of({{0, 0}, {1, 0}, {2, 0}, {0, 1}, {0, 2}, {1, 2}, {2, 1}}); // all except (2, 2)
    ASSERT_EQ(outlines.size(), 1U);
    EXPECT_THAT(outlines[0], ElementsAre(Ring{{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 3}, {0, 3}, {0, 0}},
                                         Ring{{2, 2}, {2, 1}, {1, 1}, {1, 2}, {2, 2}}));
}

TEST(Outline, IsEmptyWithoutCells) { EXPECT_TRUE(outlines_of({}).empty()); }

double area_of(const Ring& ring) {
    double twice = 0.0;
    for (std::size_t n = 0; n + 1 < ring.size(); ++n) {
        twice += static_cast<double>(ring[n].i) * ring[n + 1].j - static_cast<double>(ring[n + 1].i) * ring[n].j;
    }
    return 0.5 * twice;
}

/// Returns whether the ring encloses a cell, by the parity of ring sides left of its centre.
bool holds(const Ring& ring, Cell cell) {
    bool inside = false;
    for (std::size_t n = 0; n + 1 < ring.size(); ++n) {
        const auto [low, high] = std::minmax(ring[n].j, ring[n + 1].j);
        if (ring[n].i == ring[n + 1].i && ring[n].i <= cell.i && low <= cell.j && cell.j < high) inside = !inside;
    }
    return inside;
}

TEST(Outline, EnclosesExactlyTheGivenRandomCells) {
    std::mt19937 random(7);
    constexpr std::int32_t kSide = 24;
    for (int round = 0; round < 60; ++round) {
        std::vector<Cell> cells;
        std::set<std::pair<std::int32_t, std::int32_t>> set;
        for (std::int32_t n = 0; n < kSide * kSide; ++n) {
            if (random() % 10 > static_cast<unsigned>(round) % 9) continue;
            cells.push_back({n % kSide - 12, n / kSide - 12});
            set.insert({cells.back().i, cells.back().j});
        }
        std::shuffle(cells.begin(), cells.end(), random);
        const auto outlines = outlines_of(cells);
        double area = 0.0;
        for (const auto& outline : outlines) {
            for (std::size_t ring = 0; ring < outline.size(); ++ring) {
                EXPECT_EQ(outline[ring].front(), outline[ring].back());
                area += area_of(outline[ring]);
                EXPECT_EQ(area_of(outline[ring]) < 0.0, ring > 0) << "rings after the first are holes";
                std::set<std::pair<std::int32_t, std::int32_t>> corners;
                for (std::size_t n = 1; n < outline[ring].size(); ++n) {
                    EXPECT_TRUE(corners.insert({outline[ring][n].i, outline[ring][n].j}).second)
                        << "the ring touches itself";
                }
            }
        }
        EXPECT_EQ(area, static_cast<double>(cells.size()));
        for (std::int32_t n = 0; n < kSide * kSide; ++n) {
            const Cell cell{n % kSide - 12, n / kSide - 12};
            int around = 0;
            for (const auto& outline : outlines) {
                for (const auto& ring : outline) around += holds(ring, cell) ? 1 : 0;
            }
            EXPECT_EQ(around % 2 == 1, set.contains({cell.i, cell.j}));
        }
    }
}

} // namespace
} // namespace scanloom::grid

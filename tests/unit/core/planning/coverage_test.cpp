#include "core/planning/coverage.hpp"
#include "core/planning/coverage_region.hpp"
#include "tests/support/plan_worlds.hpp"
#include "tests/support/point_text.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace scanloom::planning {
namespace {

using namespace testing_support;
using testing::HasSubstr;

using CellSet = std::set<std::pair<int, int>>; // (j, i)

double distance_to_segment(const Point2& point, const Point2& a, const Point2& b) {
    const Point2 ab = b - a;
    const double length = squared_norm(ab);
    const double along = length == 0.0 ? 0.0 : std::clamp(dot(point - a, ab) / length, 0.0, 1.0);
    return norm(a + along * ab - point);
}

/// Returns the cells whose centres lie within the body's radius of the path.
CellSet within_reach(const Path& path, double cell_size_m, double radius_m) {
    CellSet cells;
    const Point2 margin{radius_m, radius_m};
    for (std::size_t at = 0; at + 1 < path.points.size(); ++at) {
        const Point2& a = path.points[at];
        const Point2& b = path.points[at + 1];
        const Point2 low = (min_corner(a, b) - margin) / cell_size_m;
        const Point2 high = (max_corner(a, b) + margin) / cell_size_m;
        for (auto j = static_cast<int>(std::floor(low.y)); j <= high.y; ++j) {
            for (auto i = static_cast<int>(std::floor(low.x)); i <= high.x; ++i) {
                if (distance_to_segment(centre({i, j}, cell_size_m), a, b) <= radius_m + 1e-9) cells.insert({j, i});
            }
        }
    }
    return cells;
}

bool is_free(const ClassView& view, int j, int i) {
    const auto value = class_at(view, {i, j});
    return value == CellClass::kFree || value == CellClass::kDanger;
}

/// Checks the contract of plan_coverage(): each free cell of the region is covered or listed as unreachable, a listed
/// cell cannot be covered from any cell that the body can reach, and the path keeps clear of obstacles.
void expect_covers(const ClassView& view, const grid::CellBox& box, double cell_size_m, const Point2& start,
                   const PassabilityOptions& options, const CellSet& region, const Coverage& coverage) {
    CellSet listed;
    for (const Cell cell : coverage.unreachable) listed.insert({cell.j, cell.i});
    const double radius = options.body_radius_m;
    const auto covered = within_reach(coverage.path, cell_size_m, radius);
    for (const auto& cell : region) {
        ASSERT_TRUE(covered.contains(cell) || listed.contains(cell)) << "cell " << cell.second << ", " << cell.first;
    }
    const Oracle oracle(view, box, cell_size_m, options);
    const auto costs = oracle.costs(
        {static_cast<int>(std::floor(start.x / cell_size_m)), static_cast<int>(std::floor(start.y / cell_size_m))});
    const int reach = static_cast<int>(radius / cell_size_m) + 1;
    for (const auto& [j, i] : listed) {
        ASSERT_TRUE(region.contains({j, i}));
        for (int dj = -reach; dj <= reach; ++dj) {
            for (int di = -reach; di <= reach; ++di) {
                if (std::hypot(di, dj) * cell_size_m > radius + 1e-9) continue;
                ASSERT_FALSE(costs.contains({j + dj, i + di})) << "cell " << i << ", " << j << " could be covered";
            }
        }
    }
    for (std::size_t at = 0; at + 1 < coverage.path.points.size(); ++at) {
        ASSERT_TRUE(
            oracle.cost_of_line(coverage.path.points[at] / cell_size_m, coverage.path.points[at + 1] / cell_size_m));
    }
    EXPECT_EQ(coverage.free_cells, static_cast<std::int64_t>(region.size()));
    EXPECT_EQ(coverage.covered_cells, static_cast<std::int64_t>(region.size() - listed.size()));
    EXPECT_NEAR(coverage.unreachable_m2, static_cast<double>(listed.size()) * cell_size_m * cell_size_m, 1e-9);
    EXPECT_NEAR(coverage.fraction, 1.0 - static_cast<double>(listed.size()) / static_cast<double>(region.size()),
                1e-12);
}

/// Returns the free cells of a world whose lower left corner is (0, 0).
CellSet free_cells(const ClassView& view, const PlanWorld& world) {
    CellSet cells;
    for (int j = 0; j < world.height(); ++j) {
        for (int i = 0; i < world.width(); ++i) {
            if (is_free(view, j, i)) cells.insert({j, i});
        }
    }
    return cells;
}

PlanWorld random_room(std::mt19937& random, std::int32_t width, std::int32_t height) {
    PlanWorld world(width, height, OccType::kFree);
    world.frame(1);
    for (int piece = 0; piece < 1 + random_below(random, 8); ++piece) {
        world.fill(random_below(random, width), random_below(random, height), 1 + random_below(random, 25),
                   1 + random_below(random, 25), random() % 4 == 0 ? OccType::kUnexplored : OccType::kOccupied);
    }
    return world;
}

void expect_every_free_cell_covered_or_listed(int rounds) {
    std::mt19937 random(71);
    int planned = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto world = random_room(random, 60 + random_below(random, 60), 60 + random_below(random, 40));
        const auto view = world.view(1 + random_below(random, 5));
        CoverageOptions options;
        options.passability.body_radius_m = std::array{0.0, 0.04, 0.1, 0.15, 0.22}[random() % 5];
        options.passability.on_known = round % 2 == 0;
        if (round % 3 == 0) options.spacing_m = 0.05;
        const Cell start{2 + random_below(random, 56), 2 + random_below(random, 56)};
        const Oracle oracle(view, {0, 0, world.width(), world.height()}, 0.05, options.passability);
        if (!oracle.enterable(start)) continue;
        const auto coverage = plan_coverage(view, 0.05, centre(start, 0.05), options).value();
        expect_covers(view, {0, 0, world.width(), world.height()}, 0.05, centre(start, 0.05), options.passability,
                      free_cells(view, world), coverage);
        ++planned;
        if (testing::Test::HasFatalFailure()) FAIL() << "in round " << round;
    }
    EXPECT_GT(planned, rounds / 2);
}

TEST(Coverage, CoversOrListsEveryFreeCell) { expect_every_free_cell_covered_or_listed(15); }
TEST(CoverageTrials, CoversOrListsEveryFreeCellOfManyRooms) { expect_every_free_cell_covered_or_listed(40); }

TEST(Coverage, StartInNarrowGapCoversTheRoomWithMostReachableCells) {
    const auto view = drawn({"##################", //
                             "#.....#..........#", //
                             "#.....#..........#", //
                             "#................#", //
                             "#.....#..........#", //
                             "#.....#..........#", //
                             "##################"});
    CoverageOptions options;
    options.passability.body_radius_m = 1.2;
    const auto coverage = plan_coverage(view, 1.0, {6.5, 3.5}, options).value();
    for (const Point2& point : coverage.path.points) EXPECT_GE(point.x, 6.5);
    EXPECT_GE(coverage.unreachable.size(), 25U) << "these cells are the room on the left";
    options.region = {{1.0, 1.0}, {5.0, 1.0}, {5.0, 6.0}, {1.0, 6.0}};
    const auto left = plan_coverage(view, 1.0, {6.5, 3.5}, options).value();
    for (const Point2& point : left.path.points) EXPECT_LE(point.x, 6.5);
    EXPECT_GT(left.fraction, 0.7);
}

/// Plans from starts where the body does not fit, in `rounds` random rooms.
/// @return number of rooms whose path left the narrow start
int leave_narrow_starts(int rounds) {
    std::mt19937 random(74);
    int left = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto world = random_room(random, 60, 50);
        const auto view = world.view();
        CoverageOptions options;
        options.passability.body_radius_m = std::array{0.1, 0.15, 0.22}[random() % 3];
        options.passability.on_known = round % 2 == 0;
        const grid::CellBox box{0, 0, world.width(), world.height()};
        const Oracle oracle(view, box, 0.05, options.passability);
        const Cell start{2 + random_below(random, 56), 2 + random_below(random, 46)};
        if (oracle.enterable(start)) continue;
        const auto coverage = plan_coverage(view, 0.05, centre(start, 0.05), options);
        if (!coverage) continue;
        EXPECT_GE(coverage->path.cost, coverage->path.length_m * (1.0 - 1e-9));
        const auto& points = coverage->path.points;
        const auto fits = [&](const Point2& point) {
            return oracle.enterable(
                {static_cast<int>(std::floor(point.x / 0.05)), static_cast<int>(std::floor(point.y / 0.05))});
        };
        const auto out = static_cast<std::size_t>(std::ranges::find_if(points, fits) - points.begin());
        for (std::size_t at = out; at + 1 < points.size(); ++at) {
            EXPECT_TRUE(oracle.keeps_clear(points[at] / 0.05, points[at + 1] / 0.05, 2e-9)) << "in round " << round;
        }
        left += out + 1 < points.size() ? 1 : 0;
    }
    return left;
}

TEST(Coverage, KeepsClearAfterLeavingNarrowStart) { EXPECT_GT(leave_narrow_starts(60), 3); }

TEST(CoverageTrials, KeepsClearAfterLeavingEachOfManyNarrowStarts) { EXPECT_GT(leave_narrow_starts(300), 20); }

TEST(Coverage, CountsFreeCellsOfTheRegion) {
    std::mt19937 random(72);
    for (int round = 0; round < 10; ++round) {
        const auto world = random_room(random, 100, 80);
        const auto view = world.view();
        const PassabilityOptions body;
        const Oracle oracle(view, {0, 0, 100, 80}, 0.05, body);
        const Cell start{50, 40};
        if (!oracle.enterable(start)) continue;
        const std::vector<Point2> corners = {{1.01, 0.51}, {4.51, 1.01}, {4.01, 3.51}, {2.01, 2.01}, {0.51, 3.01}};
        const auto inside = cells_inside(make_passability(view, 0.05, body).value(), corners).value();
        CellSet region;
        for (int j = 0; j < 80; ++j) {
            for (int i = 0; i < 100; ++i) {
                if (is_free(view, j, i) && inside.test({i, j})) region.insert({j, i});
            }
        }
        const auto coverage = plan_coverage(view, 0.05, centre(start, 0.05), {body, std::nullopt, corners});
        if (!coverage) continue; // no cell of the region is reachable
        expect_covers(view, {0, 0, 100, 80}, 0.05, centre(start, 0.05), body, region, *coverage);
    }
}

TEST(Coverage, PathInEmptyRoomIsNearTheShortest) {
    PlanWorld world(202, 102, OccType::kFree);
    world.frame(1);
    const auto coverage = plan_coverage(world.view(), 0.05, centre({10, 10}, 0.05)).value();
    EXPECT_EQ(coverage.covered_cells + static_cast<std::int64_t>(coverage.unreachable.size()), 200 * 100);
    EXPECT_LT(coverage.unreachable.size(), 30U) << "a round body cannot cover the corners";
    EXPECT_LT(coverage.path.length_m, 1.35 * 10.0 * 5.0 / 0.3) << "the lower bound is area / spacing";
    EXPECT_GT(coverage.fraction, 0.998);
}

TEST(Coverage, IsDeterministic) {
    std::mt19937 random(73);
    const auto view = random_room(random, 100, 80).view();
    const auto once = plan_coverage(view, 0.05, centre({50, 40}, 0.05)).value();
    const auto again = plan_coverage(view, 0.05, centre({50, 40}, 0.05)).value();
    EXPECT_EQ(once.path.points, again.path.points);
    EXPECT_EQ(once.unreachable, again.unreachable);
}

TEST(Coverage, ListsClosedRoomsWithAndWithoutRegion) {
    const auto view = drawn({"#########", "#...#...#", "#...#...#", "#########"});
    CoverageOptions all;
    all.passability.body_radius_m = 0.0;
    CoverageOptions lower_half = all;
    lower_half.region = {{0.0, 0.0}, {9.0, 0.0}, {9.0, 2.0}, {0.0, 2.0}};
    const auto everywhere = plan_coverage(view, 1.0, {1.5, 1.5}, all).value();
    EXPECT_EQ(everywhere.free_cells, 12);
    EXPECT_EQ(everywhere.unreachable, (std::vector<Cell>{{5, 1}, {6, 1}, {7, 1}, {5, 2}, {6, 2}, {7, 2}}));
    EXPECT_NEAR(everywhere.unreachable_m2, 6.0, 1e-12);
    EXPECT_NEAR(everywhere.fraction, 0.5, 1e-12);
    const auto lower = plan_coverage(view, 1.0, {1.5, 1.5}, lower_half).value();
    EXPECT_EQ(lower.free_cells, 6);
    EXPECT_EQ(lower.unreachable, (std::vector<Cell>{{5, 1}, {6, 1}, {7, 1}}));
}

TEST(Coverage, StartNextToWallDoesNotCoverBehindTheWall) {
    std::vector<std::string_view> rows = {".........", ".........", ".........", "#########",
                                          ".........", ".........", ".........", "........."};
    const auto view = drawn(rows);
    CoverageOptions options;
    options.passability.body_radius_m = 1.6;
    options.region = {{0.0, 0.0}, {9.0, 0.0}, {9.0, 8.0}, {0.0, 8.0}};
    const auto coverage = plan_coverage(view, 1.0, {4.5, 3.5}, options).value();
    EXPECT_EQ(coverage.path.points.front(), (Point2{4.5, 3.5}));
    for (const Cell cell : coverage.unreachable) EXPECT_GT(cell.j, 2);
    EXPECT_GE(coverage.unreachable.size(), 27U) << "all cells behind the wall are unreachable";
}

TEST(Coverage, SingleCellRegionEndsAtTheCellsCentre) {
    CoverageOptions options;
    options.passability.body_radius_m = 0.0;
    options.region = {{1.0, 1.0}, {1.9, 1.0}, {1.9, 1.9}, {1.0, 1.9}};
    const auto coverage = plan_coverage(drawn({"....", "....", "...."}), 1.0, {1.1, 1.1}, options).value();
    EXPECT_EQ(coverage.path.points, (std::vector<Point2>{{1.1, 1.1}, {1.5, 1.5}}));
    EXPECT_EQ(coverage.fraction, 1.0);
}

TEST(Coverage, StopsWhenTheCallbackReturnsAnError) {
    PlanWorld world(100, 100, OccType::kFree);
    int calls = 0;
    const auto three_times = [&]() -> Result<> {
        if (++calls <= 3) return {};
        return Error{Errc::kTooLarge, "that is enough"};
    };
    const auto coverage = plan_coverage(world.view(), 0.05, {2.5, 2.5}, {}, three_times);
    ASSERT_FALSE(coverage);
    EXPECT_EQ(coverage.error().message, "that is enough");
    EXPECT_EQ(calls, 4);
}

TEST(Coverage, SkipsPositionsWhoseCellsAreAlreadyCovered) {
    PlanWorld world(400, 300, OccType::kFree);
    int legs = 0;
    const auto count = [&]() -> Result<> {
        ++legs;
        return {};
    };
    CoverageOptions options;
    options.passability.body_radius_m = 1.0;
    const auto coverage = plan_coverage(world.view(), 0.05, {1.0, 1.0}, options, count).value();
    EXPECT_GT(coverage.fraction, 0.99);
    EXPECT_LT(legs, 100) << "rows of 15 m in total at a spacing of 2 m, plus the gaps between their ends";
}

TEST(Coverage, RefusesInvalidStartsAndRegions) {
    const auto view = drawn({"#....", "#....", "#...."});
    CoverageOptions options;
    options.passability.body_radius_m = 0.0;
    const auto message = [&](const Point2& start) { return plan_coverage(view, 1.0, start, options).error().message; };
    EXPECT_THAT(message({0.5, 0.5}), HasSubstr("start (0.5, 0.5) is inside an obstacle"));
    options.region = {{0.0, 0.0}, {1.0, 1.0}};
    EXPECT_THAT(message({1.5, 0.5}), HasSubstr("region has 2 corners"));
    options.region = {{0.0, 0.0}, {1.0, 1.0}, {kInfinite, 0.0}};
    EXPECT_THAT(message({1.5, 0.5}), HasSubstr("region[2]"));
    options.region = {{10.0, 10.0}, {12.0, 10.0}, {11.0, 12.0}};
    EXPECT_THAT(message({1.5, 0.5}), HasSubstr("the region holds the centre of no free cell"));
    options.region.clear();
    for (const double bad : {-1.0, 1.1, std::nan("")}) {
        options.spacing_m = bad;
        EXPECT_THAT(message({1.5, 0.5}), HasSubstr("spacing")) << bad;
    }
    options.spacing_m = 1.0;
    EXPECT_TRUE(plan_coverage(view, 1.0, {1.5, 0.5}, options));
}

TEST(Region, ContainsCellsWhoseCentresAreInsideThePolygon) {
    std::mt19937 random(74);
    std::uniform_real_distribution<double> coordinate(-1.0, 4.0);
    const auto passability = make_passability(drawn({std::string(130, '.')}), 0.05, {}).value();
    for (int round = 0; round < 50; ++round) {
        std::vector<Point2> corners;
        for (int n = 0; n < 3 + round % 6; ++n) corners.push_back({coordinate(random), coordinate(random)});
        const auto inside = cells_inside(passability, corners).value();
        for (std::int32_t y = 0; y < inside.height(); ++y) {
            for (std::int32_t x = 0; x < inside.width(); ++x) {
                const Point2 point = passability.centre_of({x, y});
                bool expected = false; // a ray to the left crosses an odd number of edges if the cell is inside
                for (std::size_t n = 0; n < corners.size(); ++n) {
                    const Point2 a = corners[n];
                    const Point2 b = corners[(n + 1) % corners.size()];
                    if ((a.y > point.y) == (b.y > point.y)) continue;
                    const double x_at = a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y);
                    if (x_at < point.x) expected = !expected;
                }
                ASSERT_EQ(inside.test({x, y}), expected) << text_of(point);
            }
        }
    }
}

TEST(Sweep, SplitsRowsAroundAnObstacleIntoBlocks) {
    BitGrid ground(64, 9);
    for (std::int32_t y = 0; y < 9; ++y) {
        for (std::int32_t x = 2; x < 20; ++x) {
            const bool obstacle = x >= 8 && x < 12 && y >= 3 && y < 7;
            if (!obstacle) ground.set({x, y});
        }
    }
    const auto blocks = sweep_blocks(ground, 2);
    ASSERT_EQ(blocks.size(), 4U) << "below, left, right, above";
    EXPECT_EQ(blocks[0], (SweepBlock{{0, 2, 20}, {2, 2, 20}}));
    EXPECT_EQ(blocks[1], (SweepBlock{{4, 2, 8}, {6, 2, 8}}));
    EXPECT_EQ(blocks[2], (SweepBlock{{4, 12, 20}, {6, 12, 20}}));
    EXPECT_EQ(blocks[3], (SweepBlock{{8, 2, 20}}));
    EXPECT_TRUE(sweep_blocks(BitGrid(64, 5), 1).empty());
}

} // namespace
} // namespace scanloom::planning

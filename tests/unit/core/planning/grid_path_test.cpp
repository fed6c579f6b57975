#include "core/planning/grid_path.hpp"
#include "core/planning/line_of_sight.hpp"
#include "tests/support/point_text.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::planning {
namespace {

using namespace testing_support;
using testing::HasSubstr;

constexpr grid::CellBox kBox{-30, -25, 45, 40};
constexpr double kCellSize = 0.05;

Cell random_cell(std::mt19937& random) {
    return {kBox.i_begin + random_below(random, 75), kBox.j_begin + random_below(random, 65)};
}

PassabilityOptions random_options(std::mt19937& random) {
    const std::array radii = {0.0, 0.0, 0.04, 0.1};
    const std::array costs = {0.0, 1.0, 0.3, 25.0};
    return {radii[random() % 4], costs[random() % 4], random() % 4 == 0};
}

/// Returns the oracle's cost of a path (m), or nullopt if the path touches a cell that must not be entered.
std::optional<double> cost_of(const Oracle& oracle, const Path& path) {
    double cost = 0.0;
    for (std::size_t at = 0; at + 1 < path.points.size(); ++at) {
        const auto piece = oracle.cost_of_line(path.points[at] / kCellSize, path.points[at + 1] / kCellSize);
        if (!piece) return std::nullopt;
        cost += *piece * kCellSize;
    }
    return cost;
}

void expect_minimal_costs(int rounds) {
    std::mt19937 random(31);
    int found = 0;
    int none = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto options = random_options(random);
        const auto view = scattered(random, kBox, options.body_radius_m > 0.0 ? 4 : 28);
        const Oracle oracle(view, kBox, kCellSize, options);
        const Cell start = random_cell(random);
        if (!oracle.enterable(start)) continue;
        const auto costs = oracle.costs(start);
        for (int n = 0; n < 20; ++n) {
            const Cell goal = random_cell(random);
            const auto path =
                plan_path(view, kCellSize, centre(start, kCellSize), centre(goal, kCellSize), options, Shape::kSteps);
            const auto expected = costs.find({goal.j, goal.i});
            // All cells outside the box are unknown. If unknown cells may be entered, there are paths that the oracle
            // does not have.
            if (options.allow_unknown && expected == costs.end()) continue;
            ASSERT_EQ(path.has_value(), expected != costs.end()) << "from " << start.i << ", " << start.j;
            (path ? found : none) += 1;
            if (!path) continue;
            if (!options.allow_unknown) {
                ASSERT_NEAR(path->cost, expected->second * kCellSize, 1e-9 * expected->second);
                ASSERT_NEAR(cost_of(oracle, *path).value(), path->cost, 1e-7);
            }
            ASSERT_LE(path->cost, expected->second * kCellSize * (1.0 + 1e-9));
        }
    }
    EXPECT_GT(found, 3 * rounds);
    EXPECT_GT(none, 3 * rounds);
}

TEST(GridPath, CostIsMinimalOverAllPaths) { expect_minimal_costs(20); }
TEST(GridPathTrials, CostIsMinimalOverAllPathsOfManyMaps) { expect_minimal_costs(60); }

TEST(GridPath, StraighteningKeepsClearAndNeverCostsMore) {
    std::mt19937 random(32);
    int shortened = 0;
    for (int round = 0; round < 120; ++round) {
        auto options = random_options(random);
        options.allow_unknown = false;
        const auto view = scattered(random, kBox, round % 12 == 0 ? 0 : options.body_radius_m > 0.0 ? 2 : 8);
        const Oracle oracle(view, kBox, kCellSize, options);
        const auto start = centre(random_cell(random), kCellSize);
        const auto goal = centre(random_cell(random), kCellSize);
        const auto steps = plan_path(view, kCellSize, start, goal, options, Shape::kSteps);
        const auto path = plan_path(view, kCellSize, start, goal, options, Shape::kStraightened);
        ASSERT_EQ(steps.has_value(), path.has_value());
        if (!path) continue;
        ASSERT_LE(path->cost, steps->cost * (1.0 + 1e-9));
        shortened += path->cost < steps->cost * 0.99 ? 1 : 0;
        if (!oracle.enterable({static_cast<int>(std::floor(start.x / kCellSize)),
                               static_cast<int>(std::floor(start.y / kCellSize))})) {
            continue; // the path leaves the surroundings of an obstacle through cells that are closed for the oracle
        }
        ASSERT_NEAR(cost_of(oracle, *path).value_or(-1.0), path->cost, 1e-7);
    }
    EXPECT_GT(shortened, 10);
}

/// Plans in `rounds` random maps and compares each path's clearance with all occupied squares.
/// @return number of paths found
int compare_clearance(int rounds) {
    std::mt19937 random(37);
    int found = 0;
    for (int round = 0; round < rounds; ++round) {
        const double cell_size = std::array{0.05, 0.1, 0.25, 0.5}[random() % 4];
        const PassabilityOptions options{.body_radius_m = std::array{0.05, 0.12, 0.15, 0.2, 0.35}[random() % 5],
                                         .on_known = random() % 2 == 0};
        const auto view = scattered(random, kBox, options.on_known ? 1 : 2);
        const auto anywhere = [&] {
            std::uniform_real_distribution<double> part(0.0, 1.0);
            const Cell cell = random_cell(random);
            return Point2{(cell.i + part(random)) * cell_size, (cell.j + part(random)) * cell_size};
        };
        const Point2 start = centre(random_cell(random), cell_size);
        const Oracle oracle(view, kBox, cell_size, options);
        if (!oracle.keeps_clear(start / cell_size, start / cell_size)) continue;
        const auto path = plan_path(view, cell_size, start, anywhere(), options);
        if (!path) continue;
        ++found;
        for (std::size_t at = 0; at + 1 < path->points.size(); ++at) {
            const double slack = at + 2 == path->points.size() ? 0.05 : 2e-9;
            EXPECT_TRUE(oracle.keeps_clear(path->points[at] / cell_size, path->points[at + 1] / cell_size, slack))
                << text_of(path->points[at]) << " to " << text_of(path->points[at + 1]) << ", cells of " << cell_size
                << " m, body of " << options.body_radius_m;
        }
        EXPECT_TRUE(oracle.keeps_clear(path->points.back() / cell_size, path->points.back() / cell_size, 2e-9));
    }
    return found;
}

TEST(GridPath, KeepsBodyRadiusFromEveryOccupiedSquare) { EXPECT_GT(compare_clearance(80), 20); }

TEST(GridPathTrials, KeepsBodyRadiusFromEveryOccupiedSquareOfManyMaps) { EXPECT_GT(compare_clearance(400), 100); }

TEST(GridPath, RefusesGoalNearerToAnObstacleThanTheBodyRadius) {
    const auto view = drawn({"#####", ".....", "....."});
    const PassabilityOptions body{.body_radius_m = 0.4};
    EXPECT_TRUE(plan_path(view, 1.0, {0.5, 0.5}, {3.5, 1.55}, body));
    const auto refused = plan_path(view, 1.0, {0.5, 0.5}, {3.5, 1.65}, body);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::kNoPath);
    EXPECT_THAT(refused.error().message, HasSubstr("nearer to an obstacle than the body radius of 0.4 m"));
}

TEST(GridPath, TakesAFreeStraightLine) {
    std::mt19937 random(38);
    int free = 0;
    for (int round = 0; round < 400; ++round) {
        const PassabilityOptions options{.body_radius_m = 0.1, .danger_cost = 0.0};
        const auto view = scattered(random, kBox, round % 2);
        const auto passability = make_passability(view, kCellSize, options).value();
        const Cell from = random_cell(random);
        const Cell to = random_cell(random);
        const auto path = plan_path(view, kCellSize, centre(from, kCellSize), centre(to, kCellSize), options);
        const Oracle oracle(view, kBox, kCellSize, options);
        const Point2 a{from.i + 0.5, from.j + 0.5};
        const Point2 b{to.i + 0.5, to.j + 0.5};
        if (!path || !oracle.enterable(from) || !oracle.cost_of_line(a, b) || !oracle.keeps_clear(a, b)) continue;
        ++free;
        ASSERT_EQ(path->points.size(), 2U) << text_of(a) << " to " << text_of(b);
    }
    EXPECT_GT(free, 20);
}

TEST(GridPath, StartTooNearToAWallNeverGetsNearer) {
    std::mt19937 random(39);
    int left = 0;
    for (int round = 0; round < 300; ++round) {
        const PassabilityOptions options{.body_radius_m = 0.2};
        const auto view = scattered(random, kBox, 1);
        const Oracle oracle(view, kBox, kCellSize, options);
        const Cell from = random_cell(random);
        const Cell to = random_cell(random);
        if (oracle.enterable(from)) continue;
        const Point2 start{from.i + 0.5, from.j + 0.5};
        double slack = 0.0; // clearance that the start itself lacks
        while (slack < 4.0 && !oracle.keeps_clear(start, start, slack)) slack += 0.125;
        const auto path = plan_path(view, kCellSize, centre(from, kCellSize), centre(to, kCellSize), options);
        if (!path) continue;
        ++left;
        for (const Point2& point : path->points) {
            ASSERT_TRUE(oracle.keeps_clear(point / kCellSize, point / kCellSize, slack)) << text_of(point);
        }
    }
    EXPECT_GT(left, 20);
}

TEST(GridPath, IsStraightBetweenCellCornersInOpenSpace) {
    const std::vector<std::string_view> open(12, "............");
    const auto path = plan_path(drawn(open), 1.0, {2.0, 9.0}, {2.0, 4.0}, {.body_radius_m = 0.4}).value();
    EXPECT_EQ(path.points, (std::vector<Point2>{{2.0, 9.0}, {2.0, 4.0}}));
    EXPECT_NEAR(path.cost, 5.0, 1e-12);
}

TEST(GridPath, BeginsAndEndsAtTheExactPoints) {
    std::mt19937 random(33);
    const auto view = scattered(random, kBox, 10);
    std::uniform_real_distribution<double> x(-1.4, 2.2);
    std::uniform_real_distribution<double> y(-1.2, 1.9);
    const PassabilityOptions options{.body_radius_m = 0.0};
    const Oracle oracle(view, kBox, kCellSize, options);
    int found = 0;
    for (int round = 0; round < 120; ++round) {
        const Point2 start{x(random), y(random)};
        const Point2 goal{x(random), y(random)};
        const auto path = plan_path(view, kCellSize, start, goal, options);
        if (!path) continue;
        ++found;
        ASSERT_EQ(path->points.front(), start);
        ASSERT_EQ(path->points.back(), goal);
        double length = 0.0;
        for (std::size_t at = 0; at + 1 < path->points.size(); ++at) {
            length += norm(path->points[at + 1] - path->points[at]);
        }
        ASSERT_NEAR(path->length_m, length, 1e-9);
        ASSERT_NEAR(cost_of(oracle, *path).value_or(-1.0), path->cost, 1e-7);
    }
    EXPECT_GT(found, 50);
}

TEST(GridPath, AcceptsPointsOnCellBorders) {
    std::mt19937 random(34);
    const auto view = scattered(random, kBox, 10);
    const PassabilityOptions options{.body_radius_m = 0.0};
    int found = 0;
    for (int round = 0; round < 500; ++round) {
        const Cell a = random_cell(random);
        const Cell b = random_cell(random);
        const auto path = plan_path(view, 0.25, {a.i * 0.25, a.j * 0.25}, {b.i * 0.25, b.j * 0.25 - 1e-17}, options);
        found += path ? 1 : 0;
    }
    EXPECT_GT(found, 50);
}

TEST(GridPath, AcceptsPointJustBelowAnObstacle) {
    const auto view = drawn({"####", "...."}, {0, -1});
    const auto path = plan_path(view, 1.0, {0.5, -1e-17}, {3.5, -0.5}, {.body_radius_m = 0.0}).value();
    EXPECT_NEAR(path.cost, std::hypot(3.0, 0.5), 1e-9);
    EXPECT_NEAR(path.length_m, std::hypot(3.0, 0.5), 1e-9);
}

TEST(GridPath, IsDeterministic) {
    std::mt19937 random(35);
    const auto view = scattered(random, kBox, 15);
    const PassabilityOptions options{.body_radius_m = 0.0};
    for (int round = 0; round < 20; ++round) {
        const auto start = centre(random_cell(random), kCellSize);
        const auto goal = centre(random_cell(random), kCellSize);
        const auto once = plan_path(view, kCellSize, start, goal, options);
        const auto again = plan_path(view, kCellSize, start, goal, options);
        ASSERT_EQ(once.has_value(), again.has_value());
        if (!once) continue;
        EXPECT_EQ(once->points, again->points);
        EXPECT_EQ(once->cost, again->cost);
    }
}

/// Returns the view of a sensor with a field of view of 60 degrees on open ground, or of a lane.
ClassView ahead(int cells, double slope, int half_width) {
    ClassMap map;
    for (int i = 0; i < cells; ++i) {
        for (int j = -cells; j <= cells; ++j) {
            if (std::abs(j) <= half_width + slope * i) map.set({i, j}, CellClass::kFree);
        }
    }
    return map.view();
}

TEST(GridPath, ForwardSensorStartLeavesSurroundingUnknownSpace) {
    const PassabilityOptions careful{.body_radius_m = 0.15, .on_known = true};
    const auto path = plan_path(ahead(60, 0.577, 0), kCellSize, {0.025, 0.025}, {2.0, 0.025}, careful);
    ASSERT_TRUE(path) << path.error().message;
    EXPECT_EQ(path->points.front(), (Point2{0.025, 0.025}));
    EXPECT_NEAR(path->length_m, 1.975, 0.05);
}

TEST(GridPath, OnKnownRefusesALaneNarrowerThanTheBody) {
    const PassabilityOptions careful{.body_radius_m = 0.15, .on_known = true};
    EXPECT_EQ(plan_path(ahead(60, 0.0, 1), kCellSize, {0.025, 0.025}, {2.0, 0.025}, careful).error().code,
              Errc::kNoPath);
    EXPECT_TRUE(plan_path(ahead(60, 0.0, 1), kCellSize, {0.025, 0.025}, {2.0, 0.025}, {.body_radius_m = 0.15}));
    EXPECT_TRUE(plan_path(ahead(60, 0.0, 4), kCellSize, {0.025, 0.025}, {2.0, 0.025}, careful));
    const auto refused = plan_path(ahead(60, 0.0, 4), kCellSize, {0.025, 0.025}, {2.0, 0.17}, careful);
    EXPECT_THAT(refused.error().message, HasSubstr("nearer to an obstacle or to unknown ground than the body radius"));
}

TEST(GridPath, EntersUnknownCellsOnlyIfAllowed) {
    const auto view = drawn({".f?f.", "#####"});
    const PassabilityOptions allowed{.body_radius_m = 0.0, .allow_unknown = true};
    const auto refused = plan_path(view, 1.0, {0.5, 1.5}, {4.5, 1.5}, {.body_radius_m = 0.0});
    EXPECT_EQ(refused.error().code, Errc::kNoPath);
    EXPECT_THAT(refused.error().message, HasSubstr("no path from (0.5, 1.5) to (4.5, 1.5)"));
    EXPECT_NEAR(plan_path(view, 1.0, {0.5, 1.5}, {4.5, 1.5}, allowed)->length_m, 4.0, 1e-12);
    EXPECT_TRUE(plan_path(view, 1.0, {0.5, 1.5}, {-90.0, 300.0}, allowed)) << "all cells outside the map are unknown";
    EXPECT_TRUE(plan_path(view, 1.0, {0.5, 1.5}, {2.5, -5.5}, allowed)) << "the path goes around the end of the wall";
}

TEST(GridPath, RefusesInvalidStartGoalAndOptions) {
    const auto view = drawn({"#..#"});
    const PassabilityOptions point{.body_radius_m = 0.0};
    EXPECT_THAT(plan_path(view, 1.0, {0.5, 0.5}, {1.5, 0.5}, point).error().message, HasSubstr("the start"));
    EXPECT_THAT(plan_path(view, 1.0, {1.5, 0.5}, {3.5, 0.5}, point).error().message, HasSubstr("the goal"));
    EXPECT_EQ(plan_path(view, 1.0, {1.5, 0.5}, {1.5, 0.5}, {.body_radius_m = -1.0}).error().code, Errc::kInvalidField);
}

TEST(GridPath, IsAStraightLineWithinOneCell) {
    const auto view = drawn({"#!#"});
    const auto path = plan_path(view, 1.0, {1.0, 0.2}, {1.0, 0.9}, {.body_radius_m = 0.0, .danger_cost = 2.0}).value();
    EXPECT_EQ(path.points, (std::vector<Point2>{{1.0, 0.2}, {1.0, 0.9}}));
    EXPECT_NEAR(path.length_m, 0.7, 1e-12);
    EXPECT_NEAR(path.cost, 2.1, 1e-12);
}

TEST(GridPath, StartTooNearToAWallFindsAPath) {
    const auto view = drawn({"##########", "..........", "..........", "..........", "..........", ".........."});
    const auto path = plan_path(view, 1.0, {2.5, 4.5}, {8.5, 0.5}, {.body_radius_m = 1.6}).value();
    EXPECT_EQ(path.points.front(), (Point2{2.5, 4.5}));
    EXPECT_EQ(plan_path(view, 1.0, {8.5, 0.5}, {2.5, 4.5}, {.body_radius_m = 1.6}).error().code, Errc::kNoPath);
}

TEST(LineOfSight, CostMatchesTouchedCells) {
    std::mt19937 random(36);
    int clear = 0;
    int blocked = 0;
    for (int round = 0; round < 3000; ++round) {
        const PassabilityOptions options{.body_radius_m = 0.0, .danger_cost = 3.0};
        static const auto view = scattered(random, {0, 0, 60, 50}, 2);
        static const Oracle oracle(view, {0, 0, 60, 50}, 1.0, options);
        static const auto passability = make_passability(view, 1.0, options).value();
        std::uniform_real_distribution<double> coordinate(5.0, 45.0);
        Point2 from{coordinate(random), coordinate(random)};
        Point2 to = from + Point2{coordinate(random) - 25.0, coordinate(random) - 25.0} * 0.4;
        if (round % 2 == 0) { // centres: these lines touch corners of cells
            from = Point2{std::floor(from.x) + 0.5, std::floor(from.y) + 0.5};
            to = Point2{std::floor(to.x) + 0.5, std::floor(to.y) + 0.5};
        }
        if (!oracle.enterable({static_cast<int>(std::floor(from.x)), static_cast<int>(std::floor(from.y))})) continue;
        if (!oracle.enterable({static_cast<int>(std::floor(to.x)), static_cast<int>(std::floor(to.y))})) continue;
        const auto cost = cost_of_line(passability, from, to);
        const auto expected = oracle.cost_of_line(from, to);
        ASSERT_EQ(cost.has_value(), expected.has_value()) << text_of(from) << " to " << text_of(to);
        (cost ? clear : blocked) += 1;
        ASSERT_NEAR(cost.value_or(0.0), expected.value_or(0.0), 1e-8);
    }
    EXPECT_GT(clear, 300);
    EXPECT_GT(blocked, 300);
}

TEST(LineOfSight, LineAlongABorderTouchesBothSides) {
    const auto view = drawn({"....#", ".!...", "....."});
    const auto passability = make_passability(view, 1.0, {.body_radius_m = 0.0, .danger_cost = 3.0}).value();
    EXPECT_NEAR(cost_of_line(passability, {0.25, 1.0}, {2.75, 1.0}).value_or(-1.0), 2.5 + 3.0, 1e-12);
    EXPECT_NEAR(cost_of_line(passability, {2.0, 0.25}, {2.0, 2.75}).value_or(-1.0), 2.5 + 3.0, 1e-12);
    EXPECT_FALSE(cost_of_line(passability, {2.5, 2.0}, {4.5, 2.0}))
        << "the line runs along the obstacle's lower border";
}

} // namespace
} // namespace scanloom::planning

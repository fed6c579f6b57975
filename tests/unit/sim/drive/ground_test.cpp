#include "sim/drive/ground.hpp"

#include "tests/unit/sim/drive/drawn_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace scanloom::sim {
namespace {

/// Draws the ground, rows from the top: '#' not free, '.' the body fits, 'o' the body does not fit.
std::string drawn(const Ground& ground) {
    std::string text;
    for (auto y = static_cast<std::int32_t>(ground.passability().window.height()) - 1; y >= 0; --y) {
        for (std::int32_t x = 0; x < ground.passability().window.width(); ++x) {
            text += !ground.is_free({x, y}) ? '#' : ground.fits({x, y}) ? '.' : 'o';
        }
        text += '\n';
    }
    return text;
}

const std::vector<std::string_view> kTwoRooms{"#########", //
                                              "#...#...#", //
                                              "#...#...#", //
                                              "#.......#", //
                                              "#...#...#", //
                                              "#...#...#", //
                                              "#########"};

TEST(Ground, BodyFitsIfItsCentreIsFarEnoughFromSolids) {
    EXPECT_EQ(drawn(Ground(drawn_plan(kTwoRooms, 0.1), 0.06)), "#########\n"
                                                               "#ooo#ooo#\n"
                                                               "#o.o#o.o#\n"
                                                               "#o..o..o#\n"
                                                               "#o.o#o.o#\n"
                                                               "#ooo#ooo#\n"
                                                               "#########\n");
    EXPECT_EQ(drawn(Ground(drawn_plan(kTwoRooms, 0.1), 0.05)), "#########\n"
                                                               "#...#...#\n"
                                                               "#...#...#\n"
                                                               "#.......#\n"
                                                               "#...#...#\n"
                                                               "#...#...#\n"
                                                               "#########\n");
}

TEST(Ground, WithoutExcludesCellsNearObstacles) {
    const Ground ground(drawn_plan(kTwoRooms, 0.1), 0.05);
    const std::vector<Point2> obstacles{{0.25, 0.35}};
    EXPECT_EQ(drawn(ground.without(obstacles, 0.06)), "#########\n"
                                                      "#...#...#\n"
                                                      "#.o.#...#\n"
                                                      "#ooo....#\n"
                                                      "#.o.#...#\n"
                                                      "#...#...#\n"
                                                      "#########\n");
}

TEST(Ground, ConvertsPointsAndCellsWithNegativeCoordinates) {
    FloorPlan plan = drawn_plan({"..", ".."}, 0.1);
    plan.window = {-3, -5, -1, -3};
    const Ground ground(plan, 0.0);
    EXPECT_EQ(ground.spot_of({-0.25, -0.45}), (Spot{0, 0}));
    EXPECT_EQ(ground.spot_of(ground.centre_of({1, 1})), (Spot{1, 1}));
}

TEST(Ground, NearSolidIncludesTheOutsideOfThePlan) {
    const Ground ground(drawn_plan({".....", ".....", ".....", ".....", "....."}, 0.1), 0.0);
    EXPECT_FALSE(ground.is_near_solid({0.25, 0.25}, 0.2));
    EXPECT_TRUE(ground.is_near_solid({0.15, 0.25}, 0.2));
}

TEST(GroundPaths, PathLeadsThroughTheGapAndFitsEverywhere) {
    const Ground ground(drawn_plan(kTwoRooms, 0.1), 0.05);
    const Point2 from{0.15, 0.15};
    const Point2 to{0.75, 0.55};
    const auto path = find_path(ground, from, to);
    ASSERT_TRUE(path);
    EXPECT_EQ(path->front(), from);
    EXPECT_EQ(path->back(), to);
    EXPECT_LE(path->size(), 4U) << "unnecessary corners must be removed";
    for (std::size_t n = 0; n + 1 < path->size(); ++n) EXPECT_TRUE(ground.fits_along((*path)[n], (*path)[n + 1]));
}

TEST(GroundPaths, PathInOpenSpaceIsStraight) {
    const Ground ground(drawn_plan(kTwoRooms, 0.1), 0.05);
    EXPECT_EQ(find_path(ground, {0.15, 0.15}, {0.35, 0.55}), (std::vector<Point2>{{0.15, 0.15}, {0.35, 0.55}}));
}

TEST(GroundPaths, NoPathWithoutAGap) {
    const Ground ground(drawn_plan(kTwoRooms, 0.1), 0.06);
    EXPECT_TRUE(find_path(ground, {0.25, 0.25}, {0.25, 0.45}));
    EXPECT_FALSE(find_path(ground, {0.25, 0.25}, {0.65, 0.25}));
    EXPECT_FALSE(find_path(ground, {0.25, 0.25}, {0.15, 0.15})) << "the body does not fit at the goal";
    EXPECT_FALSE(find_path(ground, {5.0, 5.0}, {0.25, 0.25})) << "the start is far outside the plan";
}

TEST(GroundPaths, StartTooNearToAWallHasAPath) {
    const Ground ground(drawn_plan(kTwoRooms, 0.1), 0.06);
    const auto path = find_path(ground, {0.14, 0.14}, {0.25, 0.45});
    ASSERT_TRUE(path);
    EXPECT_EQ(path->front(), (Point2{0.14, 0.14}));
}

TEST(GroundPaths, NearestTargetIsThatWithTheShortestPath) {
    const Ground ground(drawn_plan(kTwoRooms, 0.1), 0.05);
    const std::vector<Point2> targets{{0.55, 0.15}, {0.15, 0.55}}; // the first target is nearer, but behind the wall
    EXPECT_EQ(nearest_by_path(ground, {0.35, 0.15}, targets), 1U);
    EXPECT_EQ(nearest_by_path(ground, {0.35, 0.15}, std::vector<Point2>{}), std::nullopt);
}

TEST(CoverageMeter, CountsCoveredPartOfTheReachableArea) {
    FloorPlan plan = drawn_plan(std::vector<std::string_view>(20, std::string_view("....................")), 0.05);
    const Ground ground(plan, 0.15);
    CoverageMeter meter(ground, reachable_from(ground, {0.5, 0.5}));
    EXPECT_NEAR(meter.reachable_m2(), 1.0, 0.03) << "the area without the corners";
    EXPECT_EQ(meter.share(), 0.0);
    for (double x = 0.15; x < 0.86; x += 0.01) meter.pass(ground, {x, 0.5});
    EXPECT_NEAR(meter.share() * meter.reachable_m2(), 0.3 * 0.7 + 0.07, 0.03);
    const double once = meter.share();
    meter.pass(ground, {0.5, 0.5});
    EXPECT_EQ(meter.share(), once) << "repeated coverage must not count";
}

} // namespace
} // namespace scanloom::sim

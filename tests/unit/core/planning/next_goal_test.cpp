#include "core/planning/goals.hpp"
#include "tests/unit/core/planning/goal_scenes.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::planning {
namespace {

using namespace testing_support;
using classify::find_frontiers;
using testing::HasSubstr;

TEST(NextGoal, IsTheReachableFrontierWithTheCheapestPath) {
    std::mt19937 random(62);
    int found = 0;
    for (int round = 0; round < 12; ++round) {
        const auto view = partly_seen(random, 6);
        const auto robot = somewhere_free(random, view);
        if (!robot) continue;
        const auto goals = frontier_goals(view, kGoalCellSize, find_frontiers(view), *robot).value();
        const auto next = next_goal(view, kGoalCellSize, *robot).value();
        double least = kInfinite;
        for (const auto& goal : goals) least = std::min(least, goal ? goal->cost : kInfinite);
        ASSERT_EQ(next.outcome, least < kInfinite ? Exploration::kGoal : Exploration::kComplete);
        if (!next.goal) continue;
        ++found;
        EXPECT_EQ(next.goal->cost, least);
        EXPECT_EQ(next.path.points.front(), *robot);
        EXPECT_NEAR(norm(next.path.points.back() - centre(next.goal->cell, kGoalCellSize)), 0.0, 1e-9);
        EXPECT_LE(next.path.cost, next.goal->cost * (1.0 + 1e-9));
        EXPECT_LE(next.path.length_m, next.goal->length_m + 1e-9);
    }
    EXPECT_GT(found, 4);
}

TEST(NextGoal, SuccessiveRequestsGetDifferentFrontiers) {
    std::mt19937 random(63);
    int second_goals = 0;
    int all_taken = 0;
    for (int round = 0; round < 15; ++round) {
        const auto view = partly_seen(random, round % 5);
        const auto frontiers = find_frontiers(view);
        std::vector<Cell> targets;
        std::set<std::size_t> given;
        for (int n = 0; n < 4; ++n) {
            const auto robot = somewhere_free(random, view);
            if (!robot) continue;
            const auto next = next_goal(view, kGoalCellSize, *robot, targets).value();
            all_taken += next.outcome == Exploration::kTakenByOthers ? 1 : 0;
            if (!next.goal) continue;
            EXPECT_TRUE(given.insert(next.goal->frontier).second) << "frontier " << next.goal->frontier;
            second_goals += given.size() > 1 ? 1 : 0;
            targets.push_back(next.goal->target);
        }
    }
    EXPECT_GT(second_goals, 10);
    EXPECT_GT(all_taken, 0);
}

TEST(NextGoal, TakenTargetExcludesItsCurrentFrontier) {
    const auto view = drawn({"f........................f", "........................."});
    const auto left = next_goal(view, 1.0, {3.5, 0.5}, {}, for_a_point()).value();
    EXPECT_EQ(left.goal->target, (Cell{0, 1}));
    const auto moved_on = next_goal(view, 1.0, {3.5, 0.5}, std::vector<Cell>{{3, 1}}, for_a_point()).value();
    EXPECT_EQ(moved_on.goal->target, (Cell{25, 1})) << "the other robot's frontier moved by 3 cells";
    const auto gone = next_goal(view, 1.0, {3.5, 0.5}, std::vector<Cell>{{12, 1}}, for_a_point()).value();
    EXPECT_EQ(gone.goal->target, (Cell{0, 1})) << "the other robot's target is explored already";
}

TEST(NextGoal, StartTooNearToAWallGetsAnEnterableGoal) {
    std::mt19937 random(77);
    int given = 0;
    for (int round = 0; round < 300; ++round) {
        const auto view = scattered(random, {0, 0, 40, 40}, 1);
        ExplorationOptions options;
        options.passability.body_radius_m = 0.1;
        options.frontier_size_min = 1;
        const Oracle oracle(view, {0, 0, 40, 40}, kGoalCellSize, options.passability);
        const Cell start{random_below(random, 40), random_below(random, 40)};
        if (oracle.enterable(start)) continue;
        const auto next = next_goal(view, kGoalCellSize, centre(start, kGoalCellSize), {}, options);
        if (!next || !next->goal) continue;
        ++given;
        ASSERT_TRUE(oracle.enterable(next->goal->cell)) << start.i << ", " << start.j;
    }
    EXPECT_GT(given, 20);
}

TEST(NextGoal, TakenSmallFrontierDoesNotExcludeALargerOneNearby) {
    const auto view = drawn({"f.ffff", "......", "......"});
    auto options = for_a_point();
    options.frontier_size_min = 2;
    const auto next = next_goal(view, 1.0, {0.5, 0.5}, std::vector<Cell>{{0, 2}}, options).value();
    ASSERT_EQ(next.outcome, Exploration::kGoal);
    EXPECT_EQ(next.goal->target.j, 2);
    EXPECT_GE(next.goal->target.i, 2);
    EXPECT_EQ(next_goal(view, 1.0, {0.5, 0.5}, std::vector<Cell>{{3, 2}}, options).value().outcome,
              Exploration::kTakenByOthers);
}

TEST(NextGoal, IsCompleteWithoutReachableFrontiers) {
    const auto closed = drawn({"#####", "#...#", "#...#", "#####"});
    EXPECT_EQ(next_goal(closed, 1.0, {2.5, 1.5}, {}, for_a_point())->outcome, Exploration::kComplete);
    const auto beyond_a_wall = drawn({"#####.f", "#...#.f", "#...#.f", "#####.f"});
    EXPECT_EQ(next_goal(beyond_a_wall, 1.0, {2.5, 1.5}, {}, for_a_point())->outcome, Exploration::kComplete);
    const auto taken = drawn({"...f"});
    EXPECT_EQ(next_goal(taken, 1.0, {0.5, 0.5}, std::vector<Cell>{{3, 0}}, for_a_point())->outcome,
              Exploration::kTakenByOthers);
}

TEST(NextGoal, IgnoresFrontiersNarrowerThanTheBodyByDefault) {
    ExplorationOptions options;
    EXPECT_EQ(frontier_size_min(options, 0.05), 4U); // 0.3 m are 4.2 cells, corner to corner
    EXPECT_EQ(frontier_size_min(options, 0.01), 21U);
    EXPECT_EQ(frontier_size_min(options, 0.5), 1U);
    EXPECT_EQ(frontier_size_min(for_a_point(), 0.05), 1U);
    options.frontier_size_min = 2;
    EXPECT_EQ(frontier_size_min(options, 0.05), 2U);

    const auto view = drawn({"..............", "..............", "..............", ".............f", ".............f",
                             ".............f", "..............", "..............", ".............."});
    options.frontier_size_min.reset();
    EXPECT_EQ(next_goal(view, kGoalCellSize, {0.3, 0.2}, {}, options)->outcome, Exploration::kComplete);
    options.frontier_size_min = 3;
    EXPECT_EQ(next_goal(view, kGoalCellSize, {0.3, 0.2}, {}, options)->outcome, Exploration::kGoal);
}

TEST(NextGoal, IgnoresGivenUpCells) {
    const auto view = drawn({"...f", "...f", "...f", "...f"});
    const std::vector<Cell> lower = {{3, 1}, {3, 0}};
    const auto next = next_goal(view, 1.0, {0.5, 0.5}, {}, for_a_point(), lower).value();
    EXPECT_EQ(next.goal->target, (Cell{3, 2}));
    EXPECT_EQ(next.given_up, 2U);
    EXPECT_EQ(next.around_target, (std::vector<Cell>{{3, 2}, {3, 3}}));
    auto options = for_a_point();
    options.frontier_size_min = 3;
    EXPECT_EQ(next_goal(view, 1.0, {0.5, 0.5}, {}, options, lower)->outcome, Exploration::kComplete)
        << "the remaining frontier is too small";
}

TEST(NextGoal, ReturnsFrontierCellsAroundTheTarget) {
    const auto view = drawn({"f..", "f..", "f..", "...", "f.."});
    auto options = for_a_point();
    options.standoff_m = 0.0;
    const auto next = next_goal(view, 1.0, {2.5, 4.5}, {}, options).value();
    EXPECT_EQ(next.around_target, (std::vector<Cell>{{0, 2}, {0, 3}, {0, 4}}));
}

TEST(UnobservedFrontier, ContainsVisibleCellsThatAreStillFrontier) {
    const auto view = drawn({"..#.f", // (4, 2) is behind the wall
                             "..#.f", //
                             ".....", // (4, 0) was frontier
                             "....f"});
    const std::vector<Cell> around = {{4, 0}, {4, 1}, {4, 2}, {4, 3}};
    EXPECT_EQ(unobservable_cells(view, {0, 2}, around), (std::vector<Cell>{{4, 0}}));
    EXPECT_EQ(unobservable_cells(view, {3, 2}, around), (std::vector<Cell>{{4, 0}, {4, 2}, {4, 3}}));
    EXPECT_EQ(still_frontier(view, around), (std::vector<Cell>{{4, 0}, {4, 2}, {4, 3}}));
}

/// Returns 24 x 24 cells of free ground that ends in frontiers on all sides.
ClassView clearing() {
    return classified({0, 0, 24, 24}, 3, [](Cell) { return OccType::kFree; });
}

/// Returns the cells of all frontiers whose column is less than `column`.
std::vector<Cell> frontier_up_to(std::int32_t column, const ClassView& view) {
    std::vector<Cell> cells;
    for (const auto& frontier : find_frontiers(view)) {
        std::ranges::copy_if(frontier.cells, std::back_inserter(cells), [&](Cell cell) { return cell.i < column; });
    }
    return cells;
}

TEST(NextGoal, OtherStartsGetNoGoalNearUnknownSpaceThatMayHideWalls) {
    const auto view = classified({0, 0, 100, 24}, 3, [](Cell cell) {
        return cell.i < 24 || (cell.j >= 10 && cell.j < 13) ? OccType::kFree : OccType::kUnexplored; // a narrow lane
    });
    EXPECT_EQ(next_goal(view, kGoalCellSize, {0.6, 0.6})->outcome, Exploration::kGoal);
    EXPECT_EQ(next_goal(view, kGoalCellSize, {0.6, 0.6}, {}, {}, frontier_up_to(60, view))->outcome,
              Exploration::kComplete);
}

TEST(NextGoal, StartSurroundedByUnknownCellsMayCrossThem) {
    const auto lane = classified({0, 0, 60, 3}, 3, [](Cell) { return OccType::kFree; }); // too narrow for the body
    const auto at_hand = next_goal(lane, kGoalCellSize, {0.1, 0.075}).value();
    ASSERT_EQ(at_hand.outcome, Exploration::kGoal);
    EXPECT_LT(at_hand.path.length_m, 0.2);
    const auto further = next_goal(lane, kGoalCellSize, {0.1, 0.075}, {}, {}, frontier_up_to(40, lane)).value();
    ASSERT_EQ(further.outcome, Exploration::kGoal);
    EXPECT_GT(further.path.length_m, 1.5);
}

TEST(NextGoal, AcceptsAnUnknownStartCellNextToKnownCells) {
    EXPECT_EQ(next_goal(clearing(), kGoalCellSize, {-0.02, 0.6})->outcome, Exploration::kGoal);
    EXPECT_THAT(next_goal(clearing(), kGoalCellSize, {-0.25, 0.6}).error().message, HasSubstr("unknown space"));
}

TEST(NextGoal, RefusesInvalidStartsAndOptions) {
    const auto view = drawn({"#..f"});
    EXPECT_THAT(next_goal(view, 1.0, {0.5, 0.5}, {}, for_a_point()).error().message, HasSubstr("inside an obstacle"));
    auto options = for_a_point();
    options.standoff_m = -1.0;
    EXPECT_THAT(next_goal(view, 1.0, {1.5, 0.5}, {}, options).error().message, HasSubstr("standoff"));
    EXPECT_THAT(frontier_goals(view, 1.0, {}, {-9.5, 0.5}, for_a_point()).error().message, HasSubstr("outside"));
}

} // namespace
} // namespace scanloom::planning

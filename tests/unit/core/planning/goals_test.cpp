#include "core/planning/goals.hpp"
#include "tests/unit/core/planning/goal_scenes.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gtest/gtest.h>

#include <set>

namespace scanloom::planning {
namespace {

using namespace testing_support;
using classify::find_frontiers;

/// Returns the cell nearest to `to`, the first one if several are equally near.
Cell nearest_of(const std::vector<Cell>& cells, Cell to) {
    Cell nearest = cells.front();
    const auto square = [&](Cell cell) {
        return (cell.i - to.i) * (cell.i - to.i) + (cell.j - to.j) * (cell.j - to.j);
    };
    for (const Cell cell : cells) {
        if (square(cell) < square(nearest)) nearest = cell;
    }
    return nearest;
}

/// Returns whether an integer (Bresenham) line between two cells crosses no occupied cell.
bool sees(const ClassView& view, Cell from, Cell to) {
    const int di = std::abs(to.i - from.i);
    const int dj = std::abs(to.j - from.j);
    const int steps = std::max(di, dj);
    for (int n = 1; n < steps; ++n) {
        const int i = (2 * n * di + steps) / (2 * steps);
        const int j = (2 * n * dj + steps) / (2 * steps);
        const Cell between{from.i + (to.i < from.i ? -i : i), from.j + (to.j < from.j ? -j : j)};
        if (class_at(view, between) == CellClass::kOccupied) return false;
    }
    return true;
}

TEST(Goals, AreCheapestPathCellsAmongNearestFreeCellsThatSeeTheFrontier) {
    std::mt19937 random(61);
    int reached = 0;
    int in_danger = 0;
    for (int round = 0; round < 12; ++round) {
        const auto view = partly_seen(random, 8);
        const auto robot = somewhere_free(random, view);
        if (!robot) continue;
        const auto frontiers = find_frontiers(view);
        auto passability = make_passability(view, kGoalCellSize, {.on_known = true}).value();
        CostSearch search(passability);
        search.from(open_start(passability, *robot).value());
        const auto goals = frontier_goals(view, kGoalCellSize, frontiers, *robot).value();
        ASSERT_EQ(goals.size(), frontiers.size());
        for (std::size_t place = 0; place < goals.size(); ++place) {
            // Examines rings of free cells around the frontier: the first ring with a reachable free cell in view of
            // the frontier contains the goal.
            std::set<std::pair<int, int>> seen;
            std::vector<Cell> ring;
            const auto is_free = [&](Cell cell) {
                return class_at(view, cell) == CellClass::kFree || class_at(view, cell) == CellClass::kDanger;
            };
            const auto add = [&](Cell cell, std::vector<Cell>& to) {
                if (is_free(cell) && seen.insert({cell.j, cell.i}).second) to.push_back(cell);
            };
            for (const Cell cell : frontiers[place].cells) {
                for (int n = 0; n < 9; ++n) add({cell.i + n % 3 - 1, cell.j + n / 3 - 1}, ring);
            }
            double best = kInfinite;
            double best_in_danger = kInfinite;
            for (int step = 1; step <= 20 && best == kInfinite; ++step) {
                double in_ring = kInfinite;
                for (const Cell cell : ring) {
                    if (!sees(view, cell, nearest_of(frontiers[place].cells, cell))) continue;
                    const double cost = search.cost(*passability.spot_of(cell)) * kGoalCellSize;
                    const bool danger = class_at(view, cell) == CellClass::kDanger;
                    (danger ? in_ring : best) = std::min(danger ? in_ring : best, cost);
                }
                if (best_in_danger == kInfinite) best_in_danger = in_ring;
                std::vector<Cell> next;
                for (const Cell cell : ring) {
                    add({cell.i + 1, cell.j}, next);
                    add({cell.i - 1, cell.j}, next);
                    add({cell.i, cell.j + 1}, next);
                    add({cell.i, cell.j - 1}, next);
                }
                ring = next;
            }
            const double expected = best < kInfinite ? best : best_in_danger;
            ASSERT_EQ(goals[place].has_value(), expected < kInfinite);
            if (!goals[place]) continue;
            ASSERT_NEAR(goals[place]->cost, expected, 1e-9);
            ASSERT_EQ(goals[place]->in_danger, best == kInfinite);
            ASSERT_EQ(goals[place]->in_danger, class_at(view, goals[place]->cell) == CellClass::kDanger);
            ASSERT_EQ(goals[place]->frontier, place);
            reached += 1;
            in_danger += goals[place]->in_danger ? 1 : 0;
        }
    }
    EXPECT_GT(reached, 20);
    EXPECT_LT(in_danger, reached / 2);
}

TEST(Goals, ContainPathLengthAndNearestFrontierCell) {
    const auto view = drawn({".........f", ".........f", ".........f"});
    const auto frontiers = find_frontiers(view);
    const auto goals = frontier_goals(view, 0.5, frontiers, {0.25, 0.75}, for_a_point()).value();
    ASSERT_TRUE(goals[0]);
    EXPECT_EQ(goals[0]->cell, (Cell{8, 1}));
    EXPECT_EQ(goals[0]->target, (Cell{9, 1}));
    EXPECT_NEAR(goals[0]->length_m, 4.0, 1e-12);
    EXPECT_NEAR(goals[0]->cost, 4.0, 1e-12);
}

TEST(Goals, SeeTheirTargetAlsoNextToCorners) {
    const auto view = drawn({"#########", "f!!#....#", "##!#.##.#", "##!!!##.#", "#########"});
    for (const auto& goal : frontier_goals(view, 1.0, find_frontiers(view), {7.5, 1.5}, for_a_point()).value()) {
        ASSERT_TRUE(goal);
        EXPECT_TRUE(sees(view, goal->cell, goal->target)) << goal->cell.i << ", " << goal->cell.j;
    }
}

TEST(Goals, OneCellCanBeTheGoalOfSeveralFrontiers) {
    const auto view = drawn({"f.f", "..."});
    const auto goals = frontier_goals(view, 1.0, find_frontiers(view), {1.5, 0.5}, for_a_point()).value();
    ASSERT_EQ(goals.size(), 2U);
    for (const auto& goal : goals) EXPECT_EQ(goal->cell, (Cell{1, 0})) << "the goal is the robot's cell";
}

TEST(Goals, AreInDangerOnlyWithoutAnAlternative) {
    const auto free_behind = drawn({"...!!!f"});
    const auto frontiers = find_frontiers(free_behind);
    const auto goal = frontier_goals(free_behind, 1.0, frontiers, {0.5, 0.5}, for_a_point()).value().front().value();
    EXPECT_EQ(goal.cell, (Cell{2, 0}));
    EXPECT_FALSE(goal.in_danger);
    const auto narrow = drawn({".!!!!!!!!!!f"});
    const auto only_danger =
        frontier_goals(narrow, 1.0, find_frontiers(narrow), {0.5, 0.5}, for_a_point()).value().front().value();
    EXPECT_EQ(only_danger.cell, (Cell{10, 0}));
    EXPECT_TRUE(only_danger.in_danger);
}

TEST(Goals, AreNotBehindAWall) {
    const auto view = drawn({"....#.f", "....#..", "....#.#", "....##."});
    const auto frontiers = find_frontiers(view);
    EXPECT_FALSE(frontier_goals(view, 1.0, frontiers, {0.5, 0.5}, for_a_point()).value().front())
        << "the frontier is 3 m away on the other side of the wall";
    const auto slanted = drawn({"#....", ".#...", "..#..", "...#.", "f...#"});
    EXPECT_FALSE(frontier_goals(slanted, 1.0, find_frontiers(slanted), {4.5, 4.5}, for_a_point()).value().front());
    const auto other_slant = drawn({"....#", "...#.", "..#..", ".#...", "#...f"});
    EXPECT_FALSE(frontier_goals(other_slant, 1.0, find_frontiers(other_slant), {0.5, 4.5}, for_a_point())->front());
}

FrontierGoals costs(const std::vector<double>& costs_of_frontiers) {
    FrontierGoals goals;
    for (std::size_t place = 0; place < costs_of_frontiers.size(); ++place) {
        FrontierGoal goal;
        goal.frontier = place;
        goal.cost = costs_of_frontiers[place];
        goals.push_back(goal.cost < 0.0 ? std::nullopt : std::optional(goal));
    }
    return goals;
}

using Assigned = std::vector<std::optional<std::size_t>>;

TEST(AssignFrontiers, AssignsTheCheapestPairFirst) {
    const std::vector<FrontierGoals> goals = {costs({4.0, 5.0, 9.0}), costs({1.0, 3.0, 7.0}), costs({2.0, 2.5, 3.0})};
    EXPECT_EQ(assign_frontiers(goals), (Assigned{2, 0, 1}));
}

TEST(AssignFrontiers, BreaksTiesByRobotThenByFrontier) {
    EXPECT_EQ(assign_frontiers(std::vector<FrontierGoals>{costs({2.0, 2.0}), costs({2.0, 2.0})}), (Assigned{0, 1}));
}

TEST(AssignFrontiers, RobotWithoutRemainingReachableFrontierGetsNone) {
    EXPECT_EQ(assign_frontiers(std::vector<FrontierGoals>{costs({1.0, -1.0}), costs({2.0, -1.0})}),
              (Assigned{0, std::nullopt}));
    EXPECT_EQ(assign_frontiers(std::vector<FrontierGoals>{costs({1.0, 3.0})}, {true, false}), (Assigned{1}));
    EXPECT_EQ(assign_frontiers(std::vector<FrontierGoals>{}), Assigned{});
}

} // namespace
} // namespace scanloom::planning

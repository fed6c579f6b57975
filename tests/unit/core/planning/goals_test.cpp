#include "core/planning/goals.hpp"
#include "tests/support/plan_worlds.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace scanloom::planning {
namespace {

using namespace testing_support;
using classify::find_frontiers;
using testing::HasSubstr;

constexpr double kGoalCellSize = 0.05;

ExplorationOptions for_a_point() {
    ExplorationOptions options;
    options.passability.body_radius_m = 0.0;
    return options;
}

/// Returns an office in which discs around `unseen_places` random cells are unexplored.
ClassView partly_seen(std::mt19937& random, int unseen_places) {
    const auto world = office(250, 250, static_cast<unsigned>(random()));
    std::vector<Cell> unseen;
    for (int n = 0; n < unseen_places; ++n) unseen.push_back({random_below(random, 250), random_below(random, 250)});
    return classified({0, 0, 250, 250}, 3, [&](Cell cell) {
        const bool hidden = std::ranges::any_of(
            unseen, [&](Cell place) { return std::hypot(cell.i - place.i, cell.j - place.j) < 12.0; });
        return hidden ? OccType::kUnexplored : world.at(cell);
    });
}

std::optional<Point2> somewhere_free(std::mt19937& random, const ClassView& view) {
    const Cell cell{random_below(random, 250), random_below(random, 250)};
    if (class_at(view, cell) != CellClass::kFree) return std::nullopt;
    return centre(cell, kGoalCellSize);
}

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

#include "core/planning/cost_search.hpp"
#include "tests/support/plan_worlds.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gtest/gtest.h>

#include <bit>

namespace scanloom::planning {
namespace {

using namespace testing_support;

constexpr grid::CellBox kSearchBox{-50, -40, 40, 50};

/// Returns mostly free ground with a few obstacles and patches of danger.
ClassView patchy(std::mt19937& random) {
    ClassMap map;
    std::vector<Cell> patches;
    for (int patch = 0; patch < 6; ++patch) {
        patches.push_back(
            {kSearchBox.i_begin + random_below(random, 90), kSearchBox.j_begin + random_below(random, 90)});
    }
    for (std::int32_t j = kSearchBox.j_begin; j < kSearchBox.j_end; ++j) {
        for (std::int32_t i = kSearchBox.i_begin; i < kSearchBox.i_end; ++i) {
            const bool danger = std::ranges::any_of(
                patches, [&](Cell patch) { return std::abs(i - patch.i) < 9 && std::abs(j - patch.j) < 7; });
            const bool obstacle = random_below(random, 100) < 2;
            map.set({i, j}, obstacle ? CellClass::kOccupied : danger ? CellClass::kDanger : CellClass::kFree);
        }
    }
    return map.view();
}

TEST(CostSearch, CostOfEachCellIsMinimalOverAllPaths) {
    std::mt19937 random(41);
    for (int round = 0; round < 16; ++round) {
        const PassabilityOptions options{round % 4 == 0 ? 0.1 : 0.0, 0.7 * (round % 3), false};
        const auto view = patchy(random);
        const Oracle oracle(view, kSearchBox, 0.05, options);
        const auto passability = make_passability(view, 0.05, options).value();
        const Cell start{random_below(random, 80) - 40, random_below(random, 80) - 30};
        if (!oracle.enterable(start)) continue;
        CostSearch search(passability);
        search.from(*passability.spot_of(start));
        const auto costs = oracle.costs(start);
        for (std::int32_t j = kSearchBox.j_begin; j < kSearchBox.j_end; ++j) {
            for (std::int32_t i = kSearchBox.i_begin; i < kSearchBox.i_end; ++i) {
                const double cost = search.cost(*passability.spot_of({i, j}));
                const auto expected = costs.find({j, i});
                ASSERT_EQ(cost < kInfinite, expected != costs.end()) << "cell " << i << ", " << j;
                if (cost < kInfinite) {
                    ASSERT_NEAR(cost, expected->second, 1e-9) << "cell " << i << ", " << j;
                }
            }
        }
    }
}

TEST(CostSearch, GoalDirectedSearchFindsTheSameCost) {
    std::mt19937 random(42);
    for (int round = 0; round < 20; ++round) {
        const auto passability =
            make_passability(patchy(random), 0.05, {0.0, round % 4 == 3 ? 300.0 : 0.4 * (round % 4), false}).value();
        const Spot start{40, 40};
        if (!passability.enterable.test(start)) continue;
        CostSearch everywhere(passability);
        CostSearch towards(passability);
        everywhere.from(start);
        for (int n = 0; n < 50; ++n) {
            const Spot goal{14 + random_below(random, 90), 24 + random_below(random, 90)};
            if (everywhere.cost(goal) == kInfinite) continue;
            towards.between(start, goal);
            ASSERT_NEAR(towards.cost(goal), everywhere.cost(goal), 1e-9);
        }
    }
}

TEST(CostSearch, SumOfStepCostsEqualsReportedCost) {
    std::mt19937 random(43);
    const auto passability = make_passability(patchy(random), 0.05, {0.0, 2.0, false}).value();
    CostSearch search(passability);
    search.from({60, 60});
    for (int n = 0; n < 200; ++n) {
        const Spot goal{14 + random_below(random, 90), 24 + random_below(random, 90)};
        if (search.cost(goal) == kInfinite) continue;
        const auto path = search.path_to(goal);
        ASSERT_EQ(path.front(), (Spot{60, 60}));
        ASSERT_EQ(path.back(), goal);
        double cost = 0.0;
        for (std::size_t at = 0; at + 1 < path.size(); ++at) {
            const Spot step{path[at + 1].x - path[at].x, path[at + 1].y - path[at].y};
            ASSERT_TRUE(std::abs(step.x) <= 1 && std::abs(step.y) <= 1);
            const int dangers =
                (passability.danger.test(path[at]) ? 1 : 0) + (passability.danger.test(path[at + 1]) ? 1 : 0);
            cost += std::hypot(step.x, step.y) * (1.0 + dangers);
        }
        ASSERT_NEAR(cost, search.cost(goal), 1e-9);
    }
}

TEST(CostSearch, NearestReturnsTheCheapestWantedCell) {
    std::mt19937 random(44);
    const auto passability = make_passability(patchy(random), 0.05, {0.0, 1.0, false}).value();
    CostSearch everywhere(passability);
    CostSearch search(passability); // reused for all rounds
    for (int round = 0; round < 100; ++round) {
        const Spot start{14 + random_below(random, 90), 24 + random_below(random, 90)};
        if (!passability.enterable.test(start)) continue;
        BitGrid wanted(passability.enterable.width(), passability.enterable.height());
        const int count = round % 2 == 0 ? round % 7 : 500;
        for (int n = 0; n < count; ++n) wanted.set({14 + random_below(random, 90), 24 + random_below(random, 90)});
        everywhere.from(start);
        double least = kInfinite;
        for_each_set(wanted, [&](Spot spot) { least = std::min(least, everywhere.cost(spot)); });
        const auto nearest = search.nearest(start, wanted);
        ASSERT_EQ(nearest.has_value(), least < kInfinite);
        if (!nearest) continue;
        ASSERT_TRUE(wanted.test(*nearest));
        ASSERT_NEAR(search.cost(*nearest), least, 1e-9);
        ASSERT_EQ(search.path_to(*nearest).front(), start);
    }
}

TEST(CostSearch, NearestBreaksTiesByRowOrder) {
    PlanWorld world(64, 64, OccType::kFree);
    const auto passability = make_passability(world.view(), 0.05, {}).value();
    const Spot start = *passability.spot_of({30, 30});
    const std::array by_rows = {Spot{-3, -5}, Spot{3, -5}, Spot{-5, -3}, Spot{5, -3},
                                Spot{-5, 3},  Spot{5, 3},  Spot{-3, 5},  Spot{3, 5}};
    for (std::uint32_t some = 1; some < 256; ++some) {
        BitGrid wanted(passability.enterable.width(), passability.enterable.height());
        for (std::uint32_t n = 0; n < by_rows.size(); ++n) {
            if ((some >> n & 1) != 0) wanted.set({start.x + by_rows[n].x, start.y + by_rows[n].y});
        }
        const Spot first = by_rows[static_cast<std::size_t>(std::countr_zero(some))];
        EXPECT_EQ(CostSearch(passability).nearest(start, wanted), (Spot{start.x + first.x, start.y + first.y}));
    }
}

TEST(CostSearch, MaximumDangerCostIsAddedExactly) {
    const auto view = drawn({".!.!.", "#####"});
    const auto passability = make_passability(view, 1.0, {0.0, kDangerCostMax, false}).value();
    CostSearch search(passability);
    search.from({0, 1});
    EXPECT_NEAR(search.cost({4, 1}), 4.0 + 2.0 * kDangerCostMax, 1e-9);
}

} // namespace
} // namespace scanloom::planning

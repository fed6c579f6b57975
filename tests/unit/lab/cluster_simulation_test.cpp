#include "lab/cluster_simulation.hpp"

#include "tests/unit/lab/cluster_oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace scanloom::lab::cluster {
namespace {

/// Few robots for a few minutes, nothing happens.
Plan quiet_plan() {
    Plan plan;
    plan.robots = 1200;
    plan.nodes = 6;
    plan.session_life_hours = 0.0;
    plan.failure_hours = 0.0;
    plan.upgrade_at_hours = 0.0;
    plan.duration_hours = 0.05;
    return plan;
}

/// The same with 2,000 sessions of one robot on each node, which are loaded at once.
Plan quiet_plan_of_single_robots() {
    Plan plan = quiet_plan();
    plan.robots = 12'000;
    plan.session_size = 1.0;
    plan.session_spread = 0.0;
    plan.load_ms = 0.0;
    return plan;
}

constexpr double kSinglesPerNode = 2'000.0;
constexpr Time kFault{60'000};
constexpr Time kNever = std::chrono::hours(1);

Outcome with_fault(const Plan& plan, End how) { return simulate(plan, {{1, how, kFault, kNever}}); }

void expect_equal(const Outcome& simulated, Oracle& oracle, const Plan& plan) {
    oracle.run();
    EXPECT_EQ(simulated.created, oracle.created);
    EXPECT_EQ(simulated.taken_over, oracle.taken_over);
    EXPECT_EQ(simulated.moved, oracle.moved);
    EXPECT_EQ(simulated.node_robots_max, oracle.fullest_ever);
    EXPECT_EQ(simulated.overload.total, oracle.overload);
    const double milliseconds = static_cast<double>((of_hours(plan.duration_hours) - kMeasureFrom).count());
    EXPECT_NEAR(simulated.node_robots_mean, oracle.fullest_sum / milliseconds, 1e-9);
    for (const Cause cause : kCauses) {
        auto& waits = oracle.waits[cause];
        std::ranges::sort(waits);
        EXPECT_EQ(simulated.waits_of(cause).count, waits.size());
        if (waits.empty()) continue;
        EXPECT_EQ(simulated.waits_of(cause).longest, waits.back());
        const auto at_most =
            std::ranges::count_if(waits, [&](Time wait) { return wait <= simulated.waits_of(cause).percentile_99; });
        EXPECT_GE(static_cast<double>(at_most), 0.99 * static_cast<double>(waits.size()));
    }
}

TEST(ClusterSimulation, EqualsASimulationOfEachMillisecond) {
    for (const double close_ms : {0.0, 10.0, 700.0}) { // 700: not all sessions are closed when their node is back
        Plan plan = quiet_plan();
        plan.robots = 60;
        plan.nodes = 4;
        plan.session_size = 4.0;
        plan.session_life_hours = 0.02;
        plan.node_cores = 0.0042;
        plan.load_ms = 400.0;
        plan.close_ms = close_ms;
        plan.duration_hours = 0.045;
        const std::vector<Outage> outages{
            {0, End::kKilled, Time(20'000), Time(22'500)},  {2, End::kStopped, Time(30'000), Time(33'000)},
            {1, End::kSilent, Time(40'003), Time(75'000)},  {0, End::kSilent, Time(70'000), Time(78'000)},
            {3, End::kKilled, Time(90'000), Time(130'000)}, {2, End::kStopped, Time(95'000), Time(100'000)},
            {0, End::kStopped, Time(95'000), Time(95'600)}, {0, End::kStopped, Time(130'001), Time(140'000)},
            {1, End::kKilled, Time(150'000), kNever},       {2, End::kKilled, Time(150'000), kNever},
            {3, End::kSilent, Time(150'000), kNever},       {0, End::kStopped, Time(150'500), Time(153'000)}};
        Oracle oracle(plan, outages);
        const Outcome simulated = simulate(plan, outages);
        EXPECT_GT(simulated.taken_over, 0U);
        EXPECT_GT(simulated.moved, 0U);
        EXPECT_GT(simulated.overload.total, Time(0));
        expect_equal(simulated, oracle, plan);
    }
}

TEST(ClusterSimulation, WaitsInTheQueueOfALoaderAreThoseOfEachMillisecond) {
    Plan plan = quiet_plan();
    plan.robots = 60;
    plan.nodes = 3;
    plan.session_size = 2.0;
    plan.load_ms = 3'000.0; // some robots wait longer than for a welcome
    const std::vector<Outage> outages{{0, End::kStopped, Time(20'000), Time(21'000)},
                                      {1, End::kStopped, Time(35'000), Time(36'000)}};
    Oracle oracle(plan, outages);
    const Outcome simulated = simulate(plan, outages);
    EXPECT_GT(simulated.waits_of(Cause::kStopped).longest, kWelcomeTimeout);
    expect_equal(simulated, oracle, plan);
}

TEST(ClusterSimulation, WithoutEventsASessionStaysWhereItsFirstRobotAsked) {
    const Plan plan = quiet_plan_of_single_robots();
    const Outcome outcome = simulate(plan);
    EXPECT_EQ(outcome.created, plan.robots);
    EXPECT_EQ(outcome.taken_over + outcome.moved + outcome.waiting, 0U);
    EXPECT_EQ(outcome.node_robots_mean, static_cast<double>(outcome.node_robots_max));
    EXPECT_LT(outcome.node_robots_max, 1.1 * kSinglesPerNode);
    EXPECT_EQ(outcome.waits_of(Cause::kStart).count, plan.robots);
    EXPECT_EQ(outcome.waits_of(Cause::kStart).longest, kAnswer);
}

TEST(ClusterSimulation, AFailedNodeSpreadsItsSessionsOverAllOthers) {
    const Plan plan = quiet_plan_of_single_robots();
    for (const End how : {End::kKilled, End::kSilent}) {
        const Outcome outcome = with_fault(plan, how);
        EXPECT_NEAR(static_cast<double>(outcome.taken_over), kSinglesPerNode, 0.1 * kSinglesPerNode);
        EXPECT_EQ(outcome.moved, 0U);
        EXPECT_NEAR(static_cast<double>(outcome.node_robots_max), kSinglesPerNode * 6.0 / 5.0, 0.1 * kSinglesPerNode);
    }
}

TEST(ClusterSimulation, AStoppedNodeSendsItsSessionsToTheNodesWithTheFewest) {
    const Plan plan = quiet_plan_of_single_robots();
    const Outcome outcome = with_fault(plan, End::kStopped);
    EXPECT_EQ(outcome.taken_over, 0U);
    EXPECT_NEAR(static_cast<double>(outcome.moved), kSinglesPerNode, 0.1 * kSinglesPerNode);
    EXPECT_EQ(outcome.node_robots_max, static_cast<std::int64_t>(plan.robots / 5)) << "all others have equally many";
}

TEST(ClusterSimulation, AnUpgradeKeepsTheBalance) {
    Plan plan = quiet_plan_of_single_robots();
    plan.upgrade_at_hours = 0.01;
    plan.restart_s = 5.0;
    plan.close_ms = 5.0; // all sessions are closed within that time
    const Outcome outcome = simulate(plan);
    EXPECT_EQ(outcome.ends[static_cast<std::size_t>(End::kStopped)], plan.nodes);
    EXPECT_LT(static_cast<double>(outcome.node_robots_max), 1.25 * kSinglesPerNode);
}

TEST(ClusterSimulation, ASessionWaitsForItsOwnCheckpointOnly) {
    Plan plan = quiet_plan_of_single_robots();
    plan.close_ms = 80.0;
    const auto& stopped = with_fault(plan, End::kStopped).waits_of(Cause::kStopped);
    EXPECT_EQ(stopped.longest, Time(80) + 2 * kAnswer) << "then it is sent on at once and welcomed";
    Plan alone = plan;
    alone.nodes = 1;
    const auto& waits = simulate(alone, {{0, End::kStopped, kFault, kFault + Time(60'000)}}).waits_of(Cause::kStopped);
    EXPECT_EQ(waits.count, plan.robots);
    EXPECT_GT(waits.longest, Time(40'000)) << "no other node runs";
}

TEST(ClusterSimulation, RobotsWaitAsLongAsLeaseAndBackoffPermit) {
    Plan plan = quiet_plan();
    plan.load_ms = 10.0;
    constexpr Time kLoads{100}; // some 20 sessions, four at a time on each of five nodes
    const auto& killed = with_fault(plan, End::kKilled).waits_of(Cause::kKilled);
    EXPECT_GE(killed.longest, kDeadAfter - kRenewEvery);
    EXPECT_LE(killed.longest, kDeadAfter + Servers::kShort + kLoads);
    const auto& silent = with_fault(plan, End::kSilent).waits_of(Cause::kSilent);
    EXPECT_GE(silent.longest, kUnconfirmedMax);
    EXPECT_LE(silent.longest, kUnconfirmedMax + Servers::kShort + kLoads) << "the lease ends before robots notice";
}

TEST(ClusterSimulation, ANodeThatIsBackAtOnceFreesItsSessions) {
    const Plan plan = quiet_plan();
    const Outcome outcome = simulate(plan, {{1, End::kKilled, kFault, kFault + Time(50)}});
    EXPECT_GT(outcome.taken_over, 0U);
    EXPECT_LT(outcome.waits_of(Cause::kKilled).longest, kDeadAfter - kRenewEvery);
}

TEST(ClusterSimulation, NewSessionsRestoreTheBalance) {
    Plan plan = quiet_plan();
    plan.upgrade_at_hours = 0.1;
    plan.restart_s = 5.0;
    plan.session_life_hours = 0.1;
    plan.duration_hours = 1.0;
    const auto balances = simulate(plan).balances;
    const auto after = std::ranges::find(balances, "after the upgrade", &Balance::when);
    ASSERT_NE(after, balances.end());
    EXPECT_EQ(after->emptiest, 0.0);
    EXPECT_GT(balances.back().emptiest, 0.5);
    EXPECT_LT(balances.back().fullest, after->fullest);
}

TEST(ClusterSimulation, EqualSeedsGiveEqualResults) {
    Plan plan = quiet_plan();
    plan.failure_hours = 0.02;
    plan.repair_minutes = 1.0;
    const auto found = [&] {
        const Outcome outcome = simulate(plan);
        return std::tuple(outcome.taken_over, outcome.node_robots_max, outcome.waits_of(Cause::kKilled).longest);
    };
    const auto first = found();
    EXPECT_EQ(found(), first);
    plan.seed = 2;
    EXPECT_NE(found(), first);
}

} // namespace
} // namespace scanloom::lab::cluster

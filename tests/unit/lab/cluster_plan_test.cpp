#include "lab/cluster_loads.hpp"
#include "lab/cluster_nodes.hpp"
#include "lab/cluster_report.hpp"
#include "lab/cluster_servers.hpp"
#include "lab/cluster_sessions.hpp"
#include "lab/cluster_simulation.hpp"
#include "lab/cluster_size.hpp"
#include "robot_client/uplink/uplink.hpp"
#include "tests/unit/lab/cluster_oracle.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <random>
#include <string>

namespace scanloom::lab::cluster {
namespace {

using testing::HasSubstr;

TEST(ClusterServers, ChooseAsTheRobotsDo) {
    constexpr std::size_t kNodes = 5;
    const Draws draws(7);
    const Order order(draws, 3, kNodes);
    NodeList list(sorted_nodes(draws, 3, kNodes));
    Servers servers(order.first());
    std::mt19937_64 random(1);
    for (int n = 0; n < 10'000; ++n) {
        const auto what = random() % 8;
        if (what == 0) {
            list.settle();
            servers.settle();
        } else {
            const auto named = what < 3 ? std::nullopt : std::optional(random() % kNodes);
            EXPECT_EQ(servers.choose_another(named, order), list.choose_another(named));
        }
        ASSERT_EQ(servers.current(), list.current());
        ASSERT_EQ(std::min(servers.wait_max(), kConnectMax), std::min<Time>(list.wait_max(), kConnectMax));
    }
}

TEST(ClusterServers, FirstNodesAndThoseAfterThemAreEquallyFrequent) {
    constexpr std::size_t kNodes = 12;
    constexpr std::uint64_t kSessions = 120'000;
    std::array<int, kNodes> first{};
    std::array<int, kNodes> after_5{}; // of the sessions that begin with node 5
    for (std::uint64_t session = 0; session < kSessions; ++session) {
        const Order order(Draws(7), session, kNodes);
        ++first[order.first()];
        if (order.first() == 5) ++after_5[order.after(5)];
    }
    for (std::size_t node = 0; node < kNodes; ++node) {
        EXPECT_NEAR(first[node], kSessions / 12.0, kSessions * 0.005);
        EXPECT_NEAR(after_5[node], node == 5 ? 0.0 : first[5] / 11.0, first[5] * 0.015);
    }
}

TEST(ClusterSimulation, PeriodsAreThoseOfTheRobots) {
    const robot::UplinkOptions options;
    EXPECT_EQ(kConnectMax, net::ServerList::kConnectMax);
    EXPECT_EQ(kWelcomeTimeout, options.protocol.welcome_timeout);
    EXPECT_EQ(kUnconfirmedMax, net::ServerList::kUnconfirmedMax);
}

TEST(ClusterSessions, SizesHaveTheirMeanAndAddUpToAllRobots) {
    Plan plan{.robots = 200'000};
    for (const double spread : {0.0, 1.0}) {
        plan.session_spread = spread;
        const auto groups = groups_of(plan, Draws(plan.seed));
        EXPECT_NEAR(static_cast<double>(plan.robots) / static_cast<double>(groups.size()), 10.0, 0.5);
        std::uint32_t next = 0;
        for (const Group& group : groups) {
            EXPECT_EQ(group.robots_begin, std::exchange(next, group.robots_end));
            EXPECT_GE(group.size(), 1U);
        }
        EXPECT_EQ(next, plan.robots);
        EXPECT_EQ(groups.front().size() == 10U && groups[1].size() == 10U, spread == 0.0);
    }
}

TEST(ClusterNodes, FailuresHaveTheirRateAndTheirShares) {
    const Plan plan{
        .nodes = 100, .failure_hours = 50.0, .silent_share = 0.25, .upgrade_at_hours = 0.0, .duration_hours = 1000.0};
    const auto outages = outages_of(plan, Draws(plan.seed));
    const double expected = 100.0 * 1000.0 / (50.0 + 0.5); // nodes do not fail while they are repaired
    EXPECT_NEAR(static_cast<double>(outages.size()), expected, 4.0 * std::sqrt(expected));
    const auto silent = std::ranges::count(outages, End::kSilent, &Outage::end);
    EXPECT_NEAR(static_cast<double>(silent), 0.25 * expected, 4.0 * std::sqrt(0.25 * expected));
    EXPECT_TRUE(std::ranges::is_sorted(outages, {}, &Outage::down));
}

TEST(ClusterNodes, AnUpgradeStopsOneNodeAfterAnother) {
    Plan plan{.nodes = 3, .failure_hours = 0.0, .upgrade_at_hours = 1.0, .restart_s = 30};
    const auto outages = outages_of(plan, Draws(plan.seed));
    ASSERT_EQ(outages.size(), 3U);
    EXPECT_EQ(outages[0].node, 0U);
    EXPECT_EQ(outages[0].down, std::chrono::hours(1));
    EXPECT_EQ(outages[0].up, outages[0].down + std::chrono::seconds(30));
    EXPECT_GT(outages[1].down, outages[0].up);
    EXPECT_EQ(outages[2].up, end_of_upgrade(plan));
    plan.upgrade_at_hours = 0.0;
    EXPECT_TRUE(outages_of(plan, Draws(plan.seed)).empty());
}

TEST(ClusterNodes, OutagesOfANodeDoNotTouch) {
    const Plan plan{.nodes = 50, .failure_hours = 2.0, .upgrade_at_hours = 5.0, .restart_s = 600};
    std::vector<Time> up(plan.nodes, Time(-1));
    for (const Outage& outage : outages_of(plan, Draws(plan.seed))) {
        EXPECT_GT(outage.down, up[outage.node]);
        EXPECT_GT(outage.up, outage.down);
        up[outage.node] = outage.up;
    }
}

TEST(ClusterLoads, FullestMachineAndOverloadsAreWeightedByTime) {
    Loads loads(2, 10.0, Time(1'000));
    loads.add(0, 50, Time(0)); // before the figures
    loads.add(0, -50, Time(1'000));
    loads.add(0, 4, Time(1'000));
    loads.add(1, 12, Time(3'000));
    loads.add(1, -6, Time(4'000));
    loads.add(1, 100, Time(4'000)); // changes at one moment are one change
    loads.add(1, -100, Time(4'000));
    loads.finish(Time(5'000));
    EXPECT_EQ(loads.fullest_ever(), 12);
    EXPECT_EQ(loads.fullest_mean(), (2 * 4 + 12 + 6) / 4.0);
    EXPECT_EQ(loads.overload().machines, 1U);
    EXPECT_EQ(loads.overload().total, Time(1'000));
    EXPECT_EQ(loads.overload().longest, Time(1'000));
}

TEST(ClusterSize, IsTheProductOfScansAndCosts) {
    const Plan plan{.robots = 100'000,
                    .rate_hz = 10.0,
                    .node_cores = 8,
                    .node_us = 45.0,
                    .database_cores = 4.0,
                    .database_mbytes = 100.0,
                    .primary_us = 11.0,
                    .standby_us = 6.4,
                    .log_bytes = 600.0};
    const Size size = size_of(plan);
    EXPECT_DOUBLE_EQ(size.scans_per_s, 1e6);
    EXPECT_DOUBLE_EQ(size.node_cores, 45.0);
    EXPECT_DOUBLE_EQ(size.primary_cores, 11.0);
    EXPECT_DOUBLE_EQ(size.standby_cores, 6.4);
    EXPECT_DOUBLE_EQ(size.log_mbytes_per_s, 600.0);
    EXPECT_DOUBLE_EQ(size.log_tbytes_per_day, 51.84);
    EXPECT_EQ(size.nodes, 8U + 1U); // 45 / 6.4 cores, and one that is down
    EXPECT_EQ(size.clusters, 8U);   // 600 / 80 MB/s; 11 / 3.2 cores are less
}

TEST(ClusterSize, FewestMachinesHaveRoomAndOneLessDoesNot) {
    const Plan plan{.robots = 5'000, .session_size = 10, .node_cores = 0.25};
    const auto nodes = nodes_needed(plan);
    ASSERT_TRUE(nodes);
    EXPECT_GE(*nodes, size_of(plan).nodes);
    const auto fullest = [&](std::size_t count) {
        Plan tried = plan;
        tried.nodes = count;
        tried.duration_hours = 1.0 / 60.0;
        tried.session_life_hours = 0.0;
        const auto outcome = simulate(tried, {{0, End::kKilled, Time(20'000), std::chrono::hours(1)}});
        return static_cast<double>(outcome.node_robots_max) * plan.rate_hz * plan.node_us / 1e6;
    };
    EXPECT_LE(fullest(*nodes), 0.8 * plan.node_cores);
    EXPECT_GT(fullest(*nodes - 1), 0.8 * plan.node_cores);
    Plan large = plan;
    large.session_size = 1000;
    large.session_spread = 0.0;
    large.node_cores = 0.2;
    EXPECT_FALSE(nodes_needed(large)) << "a session does not fit into a node";
}

TEST(ClusterReport, HasTheFiguresOfTheSimulation) {
    Plan plan{.robots = 1'000,
              .nodes = 4,
              .node_cores = 0.05,
              .failure_hours = 0.0,
              .upgrade_at_hours = 0.5,
              .duration_hours = 1.0};
    const Report report = report_of(plan);
    const auto json = boost::json::parse(json_of(plan, report)).as_object();
    EXPECT_EQ(json.at("robots"), 1'000);
    EXPECT_EQ(json.at("size").at("scans_per_s").as_double(), 10'000.0);
    EXPECT_EQ(json.at("taken_over").as_int64(), static_cast<std::int64_t>(report.outcome.taken_over));
    EXPECT_EQ(json.at("balance").as_array().size(), report.outcome.balances.size());
    EXPECT_GT(report.outcome.overload.machines, 0U);
    const std::string tables = tables_of(plan, report);
    EXPECT_THAT(tables, HasSubstr("| scans per second | 10000 |"));
    EXPECT_THAT(tables, HasSubstr("after the upgrade"));
    EXPECT_THAT(tables, HasSubstr("its node is stopped"));
    EXPECT_EQ(tables, tables_of(plan, report_of(plan)));
    EXPECT_NE(tables.back(), '\n');
}

TEST(ClusterPlan, ImpossibleCombinationsNameTheirOptions) {
    const auto why = [](const Plan& plan) { return check(plan).error().message; };
    EXPECT_TRUE(check(Plan()));
    EXPECT_THAT(why({.robots = 5}), HasSubstr("--session-size 10 is more than --robots 5"));
    EXPECT_THAT(why({.upgrade_at_hours = 24.0}), HasSubstr("--upgrade-at 24 is not within"));
    EXPECT_TRUE(check({.upgrade_at_hours = 0.0}));
    EXPECT_THAT(why({.robots = 100'000, .duration_hours = 10'000.0}),
                HasSubstr("--duration 10000 with --session-life 8"));
}

} // namespace
} // namespace scanloom::lab::cluster

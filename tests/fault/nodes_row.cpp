#include "tests/fault/nodes_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/cluster.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {
namespace {

constexpr unsigned kRobotsOfSession = 2;
constexpr unsigned kRate = 10;              // scans a second of each robot
constexpr std::uint64_t kScansBetween = 10; // of each robot, at most

std::vector<RobotPlan> plans(const Run& run, std::uint64_t seed) {
    const unsigned robots = run.is_long ? 200 : 30;
    std::vector<RobotPlan> made;
    for (unsigned n = 0; n < robots; ++n) {
        made.push_back({fmt::format("session{}", n / kRobotsOfSession), fmt::format("robot{}", n),
                        static_cast<unsigned>(seed * robots + n), std::numeric_limits<std::uint64_t>::max()});
    }
    return made;
}

/// The times that robots waited for acknowledgements, by kind of fault.
using Delays = std::map<std::string_view, std::vector<std::chrono::milliseconds>>;

void add_figures(Outcome& outcome, Delays& delays, std::size_t robots) {
    for (auto& [kind, all] : delays) {
        std::ranges::sort(all);
        outcome.figures[std::string(kind)] = all.size() / robots;
        if (all.empty()) continue;
        outcome.figures[fmt::format("{}_p99_ms", kind)] =
            static_cast<std::uint64_t>(all[all.size() * 99 / 100].count());
        outcome.figures[fmt::format("{}_longest_ms", kind)] = static_cast<std::uint64_t>(all.back().count());
    }
}

Outcome disturb_nodes(const Run& run, std::uint64_t seed, std::uint64_t faults) {
    std::mt19937_64 random(seed);
    Cluster cluster(run.server, seed);
    const auto robots = plans(run, seed);
    Fleet fleet(robots, cluster.robot_ports());
    fleet.stream(kRate);
    Delays delays;
    for (std::uint64_t fault = 0; fault < faults && !fleet.has_given_up(); ++fault) {
        (void)fleet.wait_for_acknowledged(fleet.acknowledged() + 1 + random() % (robots.size() * kScansBetween));
        const auto& kind = Cluster::faults()[fault % Cluster::faults().size()];
        auto& of_kind = delays[kind.name]; // stays empty if the fault cannot be caused here
        if (!cluster.cause(kind)) continue;
        for (const auto delay : fleet.wait_for_all()) of_kind.push_back(delay);
    }
    fleet.end();
    const auto standings = fleet.finish();
    cluster.restart_servers();
    Outcome outcome{.failures = cluster.failures()};
    add_figures(outcome, delays, robots.size());
    outcome.add(verify_server(cluster.http_port(), standings));
    return outcome;
}

} // namespace

/// One cluster for all faults, as its figures are the longest times.
Outcome run_nodes_row(const Run& run) {
    return run_cases(run, {.row = "nodes", .of_count = run.count, .run = [&](std::uint64_t seed, std::uint64_t faults) {
                               return disturb_nodes(run, seed, faults);
                           }});
}

} // namespace scanloom::fault

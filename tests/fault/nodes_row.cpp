#include "tests/fault/nodes_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <random>
#include <vector>

namespace scanloom::fault {
namespace {

constexpr unsigned kNodes = 3;
constexpr unsigned kRobotsOfSession = 2;
constexpr std::uint64_t kScansPerFault = 50; // per robot
constexpr std::uint64_t kFaultsPerCluster = 200;
constexpr std::chrono::seconds kDead{7}; // a node counts as dead after 5 s

using Clock = std::chrono::steady_clock;

std::vector<RobotPlan> plans(const Run& run, std::uint64_t seed, std::uint64_t scans) {
    const unsigned robots = run.is_long ? 200 : 30;
    std::vector<RobotPlan> made;
    for (unsigned n = 0; n < robots; ++n) {
        made.push_back({fmt::format("session{}", n / kRobotsOfSession), fmt::format("robot{}", n),
                        static_cast<unsigned>(seed * robots + n), scans});
    }
    return made;
}

/// Three servers and their database.
class Cluster {
public:
    Cluster(const Command& server, const TemporaryDirectory& place) {
        const auto database = database_.new_database();
        for (unsigned n = 0; n < kNodes; ++n) {
            const auto name = fmt::format("node{}", n);
            nodes_.push_back(std::make_unique<ServerProcess>(
                server, place.path(), std::vector<std::string>{"--node", name, "--allow-unreplicated"}, database));
            nodes_.back()->start_and_wait();
        }
    }

    [[nodiscard]] std::vector<std::uint16_t> robot_ports() const {
        std::vector<std::uint16_t> ports;
        for (const auto& node : nodes_) ports.push_back(node->robot_port());
        return ports;
    }
    [[nodiscard]] std::uint16_t http_port() const { return nodes_[0]->http_port(); }

    /// Causes one fault and returns when all servers run again. @return its kind
    std::string disturb(std::uint64_t fault, std::mt19937_64& random, Outcome& outcome) {
        ServerProcess& node = *nodes_[random() % kNodes];
        switch (fault % 5) {
        case 0: node.kill_nine(); return restarted(node, "killed");
        case 1:
            if (const int code = node.stop(); code != 0) {
                outcome.failures.push_back(fmt::format("a server exited with {} after a stop request", code));
            }
            return restarted(node, "stopped");
        case 2:
            node.signal(SIGSTOP);
            node.let_be(kDead);
            node.signal(SIGCONT);
            return "paused";
        case 3:
            database_.kill();
            database_.start();
            return "database_killed";
        default:
            node.signal(SIGSTOP); // dies without a word, and is not back before others have its sessions
            node.let_be(kDead);
            node.kill_nine();
            return restarted(node, "dead");
        }
    }

private:
    static std::string restarted(ServerProcess& node, const char* kind) {
        node.start_and_wait();
        return kind;
    }

    test::PostgresServer database_;
    std::vector<std::unique_ptr<ServerProcess>> nodes_;
};

Outcome disturb_nodes(const Run& run, std::uint64_t seed, std::uint64_t faults) {
    const TemporaryDirectory place;
    std::mt19937_64 random(seed);
    Cluster cluster(run.server, place);
    const auto robots = plans(run, seed, (faults + 1) * kScansPerFault);
    Fleet fleet(robots, cluster.robot_ports());
    Outcome outcome;
    auto& longest = outcome.figures["longest_without_all_acknowledged_ms"];
    for (std::uint64_t fault = 0; fault < faults && !fleet.has_given_up(); ++fault) {
        fleet.release((fault + 1) * kScansPerFault);
        (void)fleet.wait_for_acknowledged(fleet.acknowledged() + 1 + random() % (robots.size() * kScansPerFault));
        const auto begin = Clock::now();
        ++outcome.figures[cluster.disturb(fault, random, outcome)];
        (void)fleet.wait_for_acknowledged((fault + 1) * kScansPerFault * robots.size());
        const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
        longest = std::max(longest, static_cast<std::uint64_t>(took.count()));
    }
    fleet.release_all();
    outcome.add(verify_server(cluster.http_port(), fleet.finish()));
    return outcome;
}

} // namespace

Outcome run_nodes_row(const Run& run) {
    return run_cases(
        run, {.row = "nodes", .of_count = kFaultsPerCluster, .run = [&](std::uint64_t seed, std::uint64_t faults) {
                  return disturb_nodes(run, seed, faults);
              }});
}

} // namespace scanloom::fault

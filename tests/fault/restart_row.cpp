#include "tests/fault/restart_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <random>

namespace scanloom::fault {
namespace {

constexpr unsigned kRestartRobots = 100;
constexpr unsigned kRobotsPerSession = 10;
constexpr std::uint64_t kScansPerRestart = 50; // per robot
constexpr std::uint64_t kRestartsPerStore = 10;

std::vector<RobotPlan> plans(std::uint64_t seed, std::uint64_t scans) {
    std::vector<RobotPlan> made;
    for (unsigned n = 0; n < kRestartRobots; ++n) {
        made.push_back({fmt::format("session{}", n / kRobotsPerSession), fmt::format("robot{}", n),
                        static_cast<unsigned>(seed * kRestartRobots + n), scans});
    }
    return made;
}

Outcome restart_servers(const Run& run, std::uint64_t seed, std::uint64_t restarts) {
    const TemporaryDirectory place;
    std::mt19937_64 random(seed);
    ServerProcess server(run.server, place.path());
    Fleet fleet(plans(seed, (restarts + 1) * kScansPerRestart), server.robot_port());
    server.start_and_wait();
    Outcome outcome;
    for (std::uint64_t restart = 1; restart <= restarts && !fleet.has_given_up(); ++restart) {
        fleet.release(restart * kScansPerRestart);
        (void)fleet.wait_for_acknowledged(fleet.acknowledged() + 1 + random() % (kRestartRobots * kScansPerRestart));
        if (random() % 2 == 0) {
            server.kill_nine();
            ++outcome.figures["killed"];
        } else {
            if (const int code = server.stop(); code != 0) {
                outcome.failures.push_back(fmt::format("the server exited with {} after a stop request", code));
            }
            ++outcome.figures["stopped"];
        }
        server.start_and_wait();
    }
    fleet.release_all();
    outcome.add(verify_server(server.http_port(), fleet.finish()));
    return outcome;
}

} // namespace

Outcome run_restart_row(const Run& run) {
    return run_cases(
        run, {.row = "restart", .of_count = kRestartsPerStore, .run = [&](std::uint64_t seed, std::uint64_t restarts) {
                  return restart_servers(run, seed, restarts);
              }});
}

} // namespace scanloom::fault

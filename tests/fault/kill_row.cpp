#include "tests/fault/kill_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <random>
#include <string>
#include <vector>

namespace scanloom::fault {
namespace {

using std::chrono::microseconds;

constexpr std::uint64_t kKillsPerStore = 50; // then a new store, so that recovery stays short
constexpr std::uint64_t kScansPerKill = 300; // per robot: a session of three robots has a checkpoint every few kills
constexpr unsigned kKillRobots = 6;
constexpr std::uint64_t kMicrosUntilKill = 20'000;

/// One store, and the kills of its servers.
class Killing {
public:
    Killing(const Run& run, std::uint64_t seed, std::uint64_t kills)
        : random_(seed), kills_(kills), server_(run.server, place_.path()),
          fleet_(half_sharing(kKillRobots, seed, kills * kScansPerKill), server_.robot_port()) {}

    Outcome run() {
        const auto begin = std::chrono::steady_clock::now();
        server_.start_and_wait();
        start_takes_ = std::chrono::duration_cast<microseconds>(std::chrono::steady_clock::now() - begin);
        for (std::uint64_t kill = 1; kill <= kills_ && !fleet_.has_given_up(); ++kill) {
            fleet_.release(kill * kScansPerKill);
            kill_somewhere();
            server_.start_and_wait();
        }
        fleet_.release_all();
        const auto robots = fleet_.finish();
        outcome_.add(verify_server(server_.http_port(), robots));
        if (outcome_.passed()) stop_in_order(robots);
        return std::move(outcome_);
    }

private:
    void kill_somewhere() {
        switch (random_() % 8) {
        case 0:
        case 1: return kill_after_some_time();
        case 2: return kill_while_starting();
        case 3: return kill_while_stopping();
        default: return kill_after_some_scans();
        }
    }

    void kill_after_some_scans() {
        const std::uint64_t more = 1 + random_() % (6 * kScansPerKill);
        (void)fleet_.wait_for_acknowledged(fleet_.acknowledged() + more);
        server_.kill_nine();
        ++outcome_.figures["after_scans"];
    }

    void kill_after_some_time() {
        server_.let_be(microseconds(random_() % kMicrosUntilKill));
        server_.kill_nine();
        ++outcome_.figures["after_a_time"];
    }

    void kill_while_starting() {
        server_.kill_nine();
        server_.start();
        server_.let_be(microseconds(random_() % static_cast<std::uint64_t>(start_takes_.count())));
        server_.kill_nine();
        ++outcome_.figures["while_starting"];
    }

    void kill_while_stopping() {
        server_.signal(SIGTERM);
        server_.let_be(microseconds(random_() % kMicrosUntilKill));
        server_.kill_nine();
        ++outcome_.figures["while_stopping"];
    }

    /// A server that stopped in order must hold the same data after a restart.
    void stop_in_order(const std::vector<RobotStanding>& robots) {
        if (const int code = server_.stop(); code != 0) {
            outcome_.failures.push_back(fmt::format("the server exited with {} after a stop request", code));
        }
        server_.start_and_wait();
        auto again = verify_server(server_.http_port(), robots);
        again.acknowledged = 0; // already counted
        outcome_.add(std::move(again));
    }

    TemporaryDirectory place_;
    std::mt19937_64 random_;
    std::uint64_t kills_;
    microseconds start_takes_{0};
    ServerProcess server_;
    Outcome outcome_;
    Fleet fleet_;
};

} // namespace

Outcome run_kill_row(const Run& run) {
    return run_cases(run,
                     {.row = "kill", .of_count = kKillsPerStore, .run = [&](std::uint64_t seed, std::uint64_t kills) {
                          return Killing(run, seed, kills).run();
                      }});
}

} // namespace scanloom::fault

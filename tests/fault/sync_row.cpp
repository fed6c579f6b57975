#include "tests/fault/sync_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/readiness.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace scanloom::fault {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kScansPerStore = 1'000;
constexpr unsigned kSyncRobots = 4;

/// A thousand scans take about twenty syncs. The probability that none of so many rounds has a failed sync is
/// negligible.
constexpr std::uint64_t kRoundsMax = 20;

/// Returns `fiu-run` and its arguments, to precede the server.
Command with_failing_syncs(const Command& server) {
    const auto program = server.program.empty() ? test::program("scanloom-server") : server.program;
    std::vector<std::string> words{"-x", "-c", "enable_random name=posix/io/sync/*,probability=0.2", program.string()};
    words.insert(words.end(), server.words.begin(), server.words.end());
    return {"/usr/bin/fiu-run", std::move(words)};
}

std::uint64_t lines_ending_with(std::string_view text, const fs::path& log) {
    std::ifstream in(log);
    std::uint64_t count = 0;
    for (std::string line; std::getline(in, line);) count += line.ends_with(text) ? 1 : 0;
    return count;
}

/// Returns robots whose sessions are distinct from those of other rounds.
std::vector<RobotPlan> plans(std::uint64_t seed, std::uint64_t round, std::uint64_t scans) {
    auto made = half_sharing(kSyncRobots, seed * kRoundsMax + round, scans / kSyncRobots);
    for (auto& plan : made) plan.session += fmt::format("-{}", round);
    return made;
}

class FailingSyncs {
public:
    FailingSyncs(const Run& run, std::uint64_t seed, std::uint64_t scans)
        : seed_(seed), scans_(scans), server_(with_failing_syncs(run.server), place_.path(), {"--disk-reserve", "32"}) {
    }

    Outcome run() {
        start();
        for (std::uint64_t round = 0; round < kRoundsMax && (round == 0 || opened_again() == 0); ++round) {
            stream(round);
        }
        outcome_.figures["opened_again"] = opened_again();
        if (opened_again() == 0) outcome_.failures.emplace_back("no failed sync made the server reopen the store");
        return std::move(outcome_);
    }

private:
    /// A new store syncs about a dozen files, and each sync may fail.
    void start() {
        constexpr std::uint64_t kStartsMax = 100;
        for (std::uint64_t starts = 1; starts <= kStartsMax; ++starts) {
            ++outcome_.figures["starts"];
            server_.start();
            if (server_.becomes_ready()) return;
            (void)server_.wait();
        }
        throw std::runtime_error("the server does not start: " + server_.last_words());
    }

    void stream(std::uint64_t round) {
        Fleet fleet(plans(seed_, round, scans_), server_.robot_port());
        fleet.release_all();
        const auto robots = fleet.finish();
        (void)wait_for_readiness(server_, 200);
        outcome_.add(verify_server(server_.http_port(), robots));
        for (const auto& robot : robots) outcome_.figures["reconnects"] += robot.reconnects;
    }

    [[nodiscard]] std::uint64_t opened_again() const {
        return lines_ending_with("has been opened again", place_.path() / "log");
    }

    TemporaryDirectory place_;
    std::uint64_t seed_;
    std::uint64_t scans_;
    ServerProcess server_;
    Outcome outcome_;
};

} // namespace

Outcome run_sync_row(const Run& run) {
    if (!fs::exists("/usr/bin/fiu-run")) return {.skipped = "fiu-run is not installed: apt-get install fiu-utils"};
    return run_cases(run,
                     {.row = "sync", .of_count = kScansPerStore, .run = [&](std::uint64_t seed, std::uint64_t scans) {
                          return FailingSyncs(run, seed, scans).run();
                      }});
}

} // namespace scanloom::fault

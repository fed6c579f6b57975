#include "tests/fault/spool_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/lidar_robot.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/tcp_proxy.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <csignal>
#include <map>
#include <random>

namespace scanloom::fault {
namespace {

constexpr int kTurnsPerRound = 30;
constexpr std::uint64_t kKillsPerSpool = 8;

/// A robot's spool over several runs of its program.
class Outages {
public:
    Outages(const Run& run, std::uint64_t seed)
        : random_(seed), program_(run.robot), server_(run.server, place_.path()) {
        server_.start_and_wait();
        link_.emplace(server_.robot_port());
    }

    Outcome run(std::uint64_t kills) {
        for (std::uint64_t kill = 0; kill < kills; ++kill) one_life();
        last_life();
        Outcome outcome = count_turns();
        const auto digest = test::http_request(server_.http_port(), "GET", "/api/v1/sessions/s/digest").body;
        outcome.digest_equal = digest == peaceful_digest(taken_);
        if (const auto left = spooled(place_.path()).size(); left > 0) {
            outcome.failures.push_back(fmt::format("{} scans that the server has stored are still in the spool", left));
        }
        return outcome;
    }

private:
    Outcome count_turns() {
        Outcome outcome;
        outcome.acknowledged = static_cast<std::uint64_t>(taken_);
        std::map<int, std::uint64_t> times_held;
        for (const int turn : turns_of(server_.http_port())) ++times_held[turn];
        for (int turn = 1; turn <= taken_; ++turn) outcome.lost += times_held.contains(turn) ? 0 : 1;
        for (const auto& [turn, times] : times_held) outcome.twice += times - 1;
        return outcome;
    }

    void one_life() {
        link_->cut();
        const std::uint64_t stored = scans_of(server_.http_port());
        Lidar lidar;
        const std::string compression = random_() % 2 == 0 ? "none" : "zstd";
        auto robot =
            start_lidar_robot(place_.path(), link_->port(), lidar,
                              {"--spool-size", "1", "--batch-size", "2", "--compression", compression}, program_);
        lidar.wait_for_robot();
        lidar.send(turns(taken_ + 1, taken_ + kTurnsPerRound));
        taken_ += kTurnsPerRound;
        wait_until(fmt::format("turn {} in the spool", taken_), [&] {
            const auto scans = spooled(place_.path());
            return !scans.empty() && turn_of(scans.back()) == taken_;
        });
        if (random_() % 3 > 0) {
            link_->restore();
            wait_for_scans_or_the_newest(stored + random_() % (static_cast<std::uint64_t>(taken_) - stored));
        }
        robot.signal(SIGKILL);
        (void)robot.wait();
    }

    /// Sends the rest and one more scan, as the server may already hold all others.
    void last_life() {
        link_->cut(); // it may already be cut
        link_->restore();
        Lidar lidar;
        auto robot = start_lidar_robot(place_.path(), link_->port(), lidar, {"--spool-size", "1"}, program_);
        lidar.wait_for_robot();
        lidar.send(turns(taken_ + 1, taken_ + 1));
        taken_ += 1;
        wait_for_scans_or_the_newest(static_cast<std::uint64_t>(taken_));
        robot.signal(SIGTERM);
        (void)robot.wait();
    }

    /// Scans arrive in the order in which they were taken: a scan missing when the newest has arrived never arrives.
    void wait_for_scans_or_the_newest(std::uint64_t scans) {
        wait_until(fmt::format("{} scans on the server, or turn {}", scans, taken_), [&] {
            if (scans_of(server_.http_port()) >= scans) return true;
            const auto turns = turns_of(server_.http_port());
            return !turns.empty() && turns.back() == taken_;
        });
    }

    TemporaryDirectory place_;
    std::mt19937_64 random_;
    Command program_; // the robot's
    ServerProcess server_;
    std::optional<test::TcpProxy> link_;
    int taken_ = 0;
};

} // namespace

Outcome run_spool_row(const Run& run) {
    return run_cases(run,
                     {.row = "spool", .of_count = kKillsPerSpool, .run = [&](std::uint64_t seed, std::uint64_t kills) {
                          return Outages(run, seed).run(kills);
                      }});
}

} // namespace scanloom::fault

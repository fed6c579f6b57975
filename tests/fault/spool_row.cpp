#include "tests/fault/spool_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/lidar_robot.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/tcp_proxy.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <csignal>
#include <random>

namespace scanloom::fault {
namespace {

constexpr int kTurnsPerRound = 30;
constexpr std::uint64_t kKillsPerSpool = 8;

/// A robot's spool through several lives of its program.
class Outages {
public:
    Outages(const Run& run, std::uint64_t seed) : random_(seed), server_(run.server, place_.path()) {
        server_.start_and_wait();
        link_.emplace(server_.robot_port());
    }

    Outcome run(std::uint64_t kills) {
        for (std::uint64_t kill = 0; kill < kills; ++kill) one_life();
        last_life();
        Outcome outcome;
        outcome.acknowledged = static_cast<std::uint64_t>(taken_);
        const std::uint64_t held = scans_of(server_.http_port());
        outcome.lost = outcome.acknowledged - std::min(held, outcome.acknowledged);
        outcome.twice = held - std::min(held, outcome.acknowledged);
        const auto digest = test::http_request(server_.http_port(), "GET", "/api/v1/sessions/s/digest").body;
        outcome.digest_equal = digest == peaceful_digest(taken_);
        if (const auto left = spooled(place_.path()).size(); left > 0) {
            outcome.amiss.push_back(fmt::format("{} scans that the server holds are in the spool still", left));
        }
        return outcome;
    }

private:
    void one_life() {
        link_->cut();
        const std::uint64_t stored = scans_of(server_.http_port());
        Lidar lidar;
        const std::string compression = random_() % 2 == 0 ? "none" : "zstd";
        auto robot =
            start_lidar_robot(place_.path(), link_->port(), lidar, {"--spool-size", "1", "--compression", compression});
        lidar.wait_for_robot();
        lidar.send(turns(taken_ + 1, taken_ + kTurnsPerRound));
        taken_ += kTurnsPerRound;
        wait_until(fmt::format("turn {} in the spool", taken_), [&] {
            const auto scans = spooled(place_.path());
            return !scans.empty() && turn_of(scans.back()) == taken_;
        });
        link_->restore();
        wait_for_scans(server_.http_port(), stored + random_() % (static_cast<std::uint64_t>(taken_) - stored));
        robot.signal(SIGKILL);
        (void)robot.wait();
    }

    /// Sends the rest, and one more: the server may hold all others by now.
    void last_life() {
        Lidar lidar;
        auto robot = start_lidar_robot(place_.path(), link_->port(), lidar, {"--spool-size", "1"});
        lidar.wait_for_robot();
        lidar.send(turns(taken_ + 1, taken_ + 1));
        taken_ += 1;
        wait_for_scans(server_.http_port(), static_cast<std::uint64_t>(taken_));
        robot.signal(SIGTERM);
        (void)robot.wait();
    }

    TemporaryDirectory place_;
    std::mt19937_64 random_;
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

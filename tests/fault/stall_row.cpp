#include "tests/fault/stall_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/loop_disk.hpp"
#include "tests/fault/process_memory.hpp"
#include "tests/fault/readiness.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>

namespace scanloom::fault {
namespace {

constexpr std::uint64_t kStallsPerDisk = 5;
constexpr std::uint64_t kScansPerStall = 100; // per robot
constexpr unsigned kStallRobots = 4;

/// Longer than a stall of the disk.
constexpr LinkTimeouts kStallTimeouts{.welcome = std::chrono::milliseconds(10'000),
                                      .silence_max = std::chrono::milliseconds(15'000)};

/// Robots may have as much data in progress as their credits permit; here the credits are small.
constexpr std::uint64_t kGrowthMax = std::uint64_t{4} << 20;

void check_memory(std::uint64_t before, std::uint64_t after, Outcome& outcome) {
    const auto grown = after - std::min(before, after);
    if (grown <= kGrowthMax) return;
    outcome.failures.push_back(fmt::format("the server used {} KiB more while the disk was blocked", grown >> 10));
}

Result<Outcome> stall_one_disk(const Run& run, std::uint64_t seed, std::uint64_t stalls) {
    const TemporaryDirectory place;
    auto disk = LoopDisk::make(place.path() / "disk", place.path() / "store", kDiskBytes);
    if (!disk) return disk.error();
    std::mt19937_64 random(seed);
    ServerProcess server(run.server, place.path(), {"--disk-reserve", "32"});
    Fleet fleet(half_sharing(kStallRobots, seed, stalls * kScansPerStall), server.robot_port(), kStallTimeouts);
    server.start_and_wait();
    fleet.release(1);
    (void)fleet.wait_for_acknowledged(kStallRobots); // all sessions exist then
    Outcome outcome;
    for (std::uint64_t stall = 1; stall <= stalls && !fleet.has_given_up(); ++stall) {
        const auto before = stall * kScansPerStall - kScansPerStall / 2;
        fleet.release(before);
        (void)fleet.wait_for_acknowledged(fleet.acknowledged() + 1 + random() % (kStallRobots * kScansPerStall / 2));
        const auto memory = resident_bytes(server.id());
        const auto frozen = (*disk)->freeze();
        fleet.release(stall * kScansPerStall);
        server.let_be(std::chrono::milliseconds(200 + random() % 2'000));
        if (fleet.acknowledged() > before * kStallRobots)
            outcome.failures.emplace_back("scans that were sent while the disk was blocked were acknowledged");
        check_that_maps_are_served(server, "while the disk is blocked", outcome);
        check_memory(memory, resident_bytes(server.id()), outcome);
    }
    fleet.release_all();
    outcome.add(verify_server(server.http_port(), fleet.finish()));
    return outcome;
}

} // namespace

Outcome run_stall_row(const Run& run) {
    return run_cases(run,
                     {.row = "stall", .of_count = kStallsPerDisk, .run = [&](std::uint64_t seed, std::uint64_t stalls) {
                          auto outcome = stall_one_disk(run, seed, stalls);
                          return outcome ? std::move(*outcome) : Outcome{.skipped = outcome.error().message};
                      }});
}

} // namespace scanloom::fault

#include "tests/fault/power_row.hpp"

#include "tests/fault/cases.hpp"
#include "tests/fault/fleet.hpp"
#include "tests/fault/loop_disk.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <random>

namespace scanloom::fault {
namespace {

constexpr std::uint64_t kCutsPerDisk = 50;
constexpr std::uint64_t kScansPerCut = 200; // per robot
constexpr unsigned kPowerRobots = 4;
constexpr std::uint64_t kMicrosUntilCut = 5'000;

/// Returns the error if the disk cannot be created.
Result<Outcome> run_one(const Run& run, std::uint64_t seed, std::uint64_t cuts) {
    const TemporaryDirectory place;
    auto disk = LoopDisk::make(place.path() / "disk", place.path() / "store", kDiskBytes);
    if (!disk) return disk.error();
    std::mt19937_64 random(seed);
    ServerProcess server(run.server, place.path(), {"--disk-reserve", "32"});
    Fleet fleet(half_sharing(kPowerRobots, seed, cuts * kScansPerCut), server.robot_port());
    server.start_and_wait();
    for (std::uint64_t cut = 1; cut <= cuts && !fleet.has_given_up(); ++cut) {
        fleet.release(cut * kScansPerCut);
        (void)fleet.wait_for_acknowledged(fleet.acknowledged() + random() % (kPowerRobots * kScansPerCut));
        server.let_be(std::chrono::microseconds(random() % kMicrosUntilCut)); // sometimes during a write
        // Linux lets an fdatasync in progress return success when the file system is shut down meanwhile. After a real
        // power failure that result would reach no client. So the server is stopped first, and never continues to
        // report it.
        server.signal(SIGSTOP);
        (*disk)->cut_power();
        server.kill_nine();
        (*disk)->mount_again();
        server.start_and_wait();
    }
    fleet.release_all();
    return verify_server(server.http_port(), fleet.finish());
}

} // namespace

Outcome run_power_row(const Run& run) {
    return run_cases(run,
                     {.row = "power", .of_count = kCutsPerDisk, .run = [&](std::uint64_t seed, std::uint64_t cuts) {
                          auto outcome = run_one(run, seed, cuts);
                          return outcome ? std::move(*outcome) : Outcome{.skipped = outcome.error().message};
                      }});
}

} // namespace scanloom::fault

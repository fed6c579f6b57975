#include "tests/fault/soak_row.hpp"

#include "tests/fault/fleet.hpp"
#include "tests/fault/process_memory.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanloom::fault {
namespace {

constexpr unsigned kRobots = 8;
constexpr std::uint64_t kParts = 40;
constexpr std::uint64_t kWarm = kParts / 2; // parts, after which nothing more may be taken

/// What a server takes that is not warm yet: entries stay in the store's write buffers until these are full.
constexpr std::uint64_t kBytesOfScan = 512;
constexpr std::uint64_t kBytesBesides = std::uint64_t{8} << 20;

/// A percent where it is warm after half of the scans, as it is in the long form.
std::uint64_t growth_max(const Run& run, std::uint64_t warm) {
    return run.count >= kSoakLong ? warm / 100 : run.count / 2 * kBytesOfScan + kBytesBesides;
}

} // namespace

Outcome run_soak_row(const Run& run) {
    const TemporaryDirectory place;
    ServerProcess server(run.server, place.path());
    const std::uint64_t scans_a_part = std::max<std::uint64_t>(1, run.count / kRobots / kParts); // of each robot
    Fleet fleet(half_sharing(kRobots, run.seed, scans_a_part * kParts), server.robot_port());
    server.start_and_wait();
    std::uint64_t warm = 0;
    std::uint64_t most = 0;
    for (std::uint64_t part = 1; part <= kParts; ++part) {
        fleet.release(part * scans_a_part);
        if (!fleet.wait_for_acknowledged(part * scans_a_part * kRobots)) break;
        (part <= kWarm ? warm : most) = std::max(part <= kWarm ? warm : most, resident_bytes(server.id()));
        run.on_progress(part * run.count / kParts);
    }
    fleet.release_all();
    auto outcome = verify_server(server.http_port(), fleet.finish());
    const auto grown = most > warm ? most - warm : 0;
    outcome.figures["memory_warm_kib"] = warm >> 10;
    outcome.figures["memory_grown_kib"] = grown >> 10;
    if (grown > growth_max(run, warm)) {
        outcome.amiss.push_back(
            fmt::format("the server's memory grew from {} to {} KiB in the second half, by at most {} it may",
                        warm >> 10, most >> 10, growth_max(run, warm) >> 10));
    }
    return outcome;
}

} // namespace scanloom::fault

#include "tests/fault/soak_row.hpp"

#include "tests/fault/fleet.hpp"
#include "tests/fault/process_memory.hpp"
#include "tests/fault/server_process.hpp"
#include "tests/fault/verification.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace scanloom::fault {
namespace {

constexpr unsigned kSoakRobots = 8;
constexpr std::uint64_t kParts = 40;
constexpr std::uint64_t kQuarter = kParts / 4; // second quarter: memory after warm-up, last: growth

/// The memory that a server takes until it is warm: entries stay in the store's write buffers until these are full.
constexpr std::uint64_t kBytesOfScan = 512;
constexpr std::uint64_t kBytesBase = std::uint64_t{8} << 20;

/// Uses the median, as the store takes some MiB more for a moment while it merges tables.
std::uint64_t median(std::vector<std::uint64_t> bytes) {
    if (bytes.empty()) return 0;
    const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2);
    std::nth_element(bytes.begin(), middle, bytes.end());
    return *middle;
}

/// One percent if the server is warm after half of the scans, as in the long form.
std::uint64_t growth_max(const Run& run, std::uint64_t warm) {
    return run.count >= kSoakLong ? warm / 100 : run.count / 2 * kBytesOfScan + kBytesBase;
}

} // namespace

Outcome run_soak_row(const Run& run) {
    const TemporaryDirectory place;
    ServerProcess server(run.server, place.path());
    const std::uint64_t scans_a_part = std::max<std::uint64_t>(1, run.count / kSoakRobots / kParts); // per robot
    Fleet fleet(half_sharing(kSoakRobots, run.seed, scans_a_part * kParts), server.robot_port());
    server.start_and_wait();
    std::vector<std::uint64_t> second;
    std::vector<std::uint64_t> last;
    for (std::uint64_t part = 1; part <= kParts; ++part) {
        fleet.release(part * scans_a_part);
        if (!fleet.wait_for_acknowledged(part * scans_a_part * kSoakRobots)) break;
        if (const auto quarter = (part - 1) / kQuarter; quarter == 1 || quarter == 3)
            (quarter == 1 ? second : last).push_back(resident_bytes(server.id()));
        run.on_progress(part * run.count / kParts);
    }
    fleet.release_all();
    auto outcome = verify_server(server.http_port(), fleet.finish());
    const auto warm = median(second);
    const auto now = median(last);
    const auto grown = now > warm ? now - warm : 0;
    outcome.figures["memory_warm_kib"] = warm >> 10;
    outcome.figures["memory_grown_kib"] = grown >> 10;
    if (grown > growth_max(run, warm)) {
        outcome.failures.push_back(
            fmt::format("the server's memory grew from {} to {} KiB in the second half, more than the allowed {} KiB",
                        warm >> 10, now >> 10, growth_max(run, warm) >> 10));
    }
    return outcome;
}

} // namespace scanloom::fault

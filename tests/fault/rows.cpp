#include "tests/fault/clock_row.hpp"
#include "tests/fault/corrupt_row.hpp"
#include "tests/fault/crowd_rows.hpp"
#include "tests/fault/disk_row.hpp"
#include "tests/fault/kill_row.hpp"
#include "tests/fault/link_row.hpp"
#include "tests/fault/nodes_row.hpp"
#include "tests/fault/power_row.hpp"
#include "tests/fault/restart_row.hpp"
#include "tests/fault/row.hpp"
#include "tests/fault/simulation_row.hpp"
#include "tests/fault/soak_row.hpp"
#include "tests/fault/spool_row.hpp"
#include "tests/fault/stall_row.hpp"
#include "tests/fault/sync_row.hpp"

#include <algorithm>

namespace scanloom::fault {
namespace {

constexpr Row kRows[] = {
    {"simulation", "stories", 2'000, 1'000'000,
     "robots and server on a simulated network, disk and clock, all with faults", run_simulation_row},
    {"kill", "kills", 50, 1'000, "kill -9 of the server at random points while robots stream", run_kill_row},
    {"link", "robots", 200, 10'000, "links that split, delay, stall, end, flip, duplicate and reorder their bytes",
     run_link_row},
    {"corrupt", "stores", 300, 10'000, "stores with flipped bits, short, empty, missing and exchanged files",
     run_corrupt_row},
    {"restart", "restarts", 3, 100, "the server is stopped or killed, and started again, while 100 robots stream",
     run_restart_row},
    {"nodes", "faults", 10, 180,
     "three servers share a database: servers and databases are killed, paused, cut off, fail over or lose power",
     run_nodes_row},
    {"clock", "jumps", 10, 1'000, "the wall clocks of server and robot jump by a year, either way", run_clock_row},
    {"power", "cuts", 10, 200, "the disk loses power: data that was not synced is lost", run_power_row},
    {"disk", "fillings", 5, 500, "a disk fills up while robots stream, then has space again", run_disk_row},
    {"sync", "scans", 1'000, 100'000, "one sync of five fails", run_sync_row},
    {"spool", "kills", 8, 800, "the network is down, and the robot is killed while it sends its spool", run_spool_row},
    {"stall", "stalls", 5, 200, "the disk blocks all writes for seconds, then completes them", run_stall_row},
    {"viewers", "viewers", 200, 1'000, "viewers that do not read", run_viewers_row},
    {"flood", "connections", 120, 600, "clients that send slowly, endlessly or invalid bytes, on both ports",
     run_flood_row},
    {"greed", "robots", 2, 8, "robots that send as fast as the server permits, with other robots", run_greed_row},
    {"soak", "scans", 80'000, kSoakLong, "the same places repeatedly: memory must not grow", run_soak_row},
};

} // namespace

std::span<const Row> rows() { return kRows; }

const Row* find_row(std::string_view name) {
    const auto found = std::ranges::find(kRows, name, &Row::name);
    return found == std::end(kRows) ? nullptr : found;
}

} // namespace scanloom::fault

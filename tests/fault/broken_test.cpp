#include "tests/fault/broken_logs.hpp"
#include "tests/fault/clock_row.hpp"
#include "tests/fault/corrupt_row.hpp"
#include "tests/fault/crowd_rows.hpp"
#include "tests/fault/disk_row.hpp"
#include "tests/fault/kill_row.hpp"
#include "tests/fault/link_row.hpp"
#include "tests/fault/nodes_row.hpp"
#include "tests/fault/power_row.hpp"
#include "tests/fault/restart_row.hpp"
#include "tests/fault/soak_row.hpp"
#include "tests/fault/spool_row.hpp"
#include "tests/fault/stall_row.hpp"
#include "tests/fault/sync_row.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>

/// Runs the rows of faults on broken programs. A row that passes here detects nothing.
namespace scanloom::fault {
namespace {

Command broken_server(const std::string& kind) { return {SCANLOOM_BROKEN_SERVER, {kind}}; }

/// Expects a failure whose messages include `because`; empty: any failure.
void expect_found(const Outcome& outcome, const std::string& because = "") {
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(std::ranges::any_of(outcome.failures, [&](const std::string& sentence) {
        return sentence.find(because) != sentence.npos;
    })) << testing::PrintToString(outcome.failures);
}

TEST(KillRow, DetectsEarlyAcknowledgements) {
    const Outcome outcome = run_kill_row({.seed = 1, .count = 10, .server = broken_server("hasty")});
    EXPECT_GT(outcome.lost, 0U);
    ASSERT_TRUE(outcome.repeat);
    EXPECT_EQ(*outcome.repeat, "./scanloom fault kill --seed 1 --count 10");
}

TEST(NodesRow, DetectsEarlyAcknowledgements) {
    EXPECT_GT(run_nodes_row({.seed = 1, .count = 4, .server = broken_server("hasty")}).lost, 0U);
}

TEST(NodesRow, DetectsRetriesOfUnansweredAppends) {
    expect_found(run_nodes_row({.seed = 1, .count = 3, .server = broken_server("retrying")}), "the log is damaged");
}

TEST(NodesRow, DetectsWritesToLostSessions) {
    expect_found(run_nodes_row({.seed = 1, .count = 10, .server = broken_server("usurping")}));
}

TEST(KillRow, DetectsDuplicates) {
    const Outcome outcome = run_kill_row({.seed = 1, .count = 10, .server = broken_server("forgetful")});
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

TEST(CorruptRow, DetectsServedCorruption) {
    const Outcome outcome = run_corrupt_row({.seed = 1, .count = 10, .server = broken_server("blind")});
    EXPECT_FALSE(outcome.digest_equal);
    EXPECT_TRUE(outcome.repeat);
}

TEST(PowerRow, DetectsMissingSyncs) {
    const Outcome outcome = run_power_row({.seed = 1, .count = 5, .server = broken_server("unsynced")});
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

TEST(StallRow, DetectsEarlyAcknowledgements) {
    const Outcome outcome = run_stall_row({.seed = 1, .count = 2, .server = broken_server("hasty")});
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

/// A kill does not reveal this fault, as data passed to the operating system survives it.
TEST(KillRow, PassesWithoutSyncs) {
    EXPECT_TRUE(run_kill_row({.seed = 1, .count = 5, .server = broken_server("unsynced")}).passed());
}

TEST(RestartRow, DetectsEarlyAcknowledgements) {
    // In the row's own three restarts, a kill may happen when all acknowledged data is already written.
    expect_found(run_restart_row({.seed = 1, .count = 12, .server = broken_server("hasty")}));
}

TEST(DiskRow, DetectsDuplicates) {
    expect_found(run_disk_row({.seed = 1, .count = 5, .server = broken_server("forgetful")}));
}

/// No data is lost, as no power fails; but the server never reopens its store.
TEST(SyncRow, DetectsIgnoredSyncErrors) {
    expect_found(run_sync_row({.seed = 1, .count = 200, .server = broken_server("trusting")}), "no failed sync");
}

TEST(SpoolRow, DetectsALostSpool) {
    const Outcome outcome = run_spool_row({.seed = 1, .count = 4, .robot = {SCANLOOM_BROKEN_ROBOT}});
    EXPECT_GT(outcome.lost, 0U);
}

TEST(ClockRow, DetectsDependenceOnTheWallClock) {
    expect_found(run_clock_row({.seed = 1, .count = 10, .server = broken_server("misled")}));
}

TEST(ClockRow, DetectsDuplicates) {
    expect_found(run_clock_row({.seed = 1, .count = 2, .server = broken_server("forgetful")}));
}

TEST(SoakRow, DetectsMemoryLeaks) {
    expect_found(run_soak_row({.seed = 1, .count = 2'000, .server = broken_server("leaky")}), "memory grew");
}

TEST(ViewersRow, DetectsMemoryForEachConnection) {
    expect_found(run_viewers_row({.seed = 1, .count = 60, .server = broken_server("hoarding")}), "MiB more with");
}

TEST(FloodRow, DetectsMemoryForEachConnection) {
    expect_found(run_flood_row({.seed = 1, .count = 60, .server = broken_server("hoarding")}), "MiB more with");
}

TEST(FloodRow, DetectsMissingDeadlines) {
    expect_found(run_flood_row({.seed = 1, .count = 12, .server = broken_server("clinging")}), "were not disconnected");
}

TEST(GreedRow, DetectsMemoryForEachScan) {
    expect_found(run_greed_row({.seed = 1, .count = 2, .server = broken_server("leaky")}), "MiB more with");
}

/// Robots must keep up in the long form. This runs one short round of it, on a server whose acknowledgements become
/// late after the run without the crowd.
Outcome keep_up_with_a_tiring_server(CrowdTrial (*row)(const Run&), std::uint64_t count) {
    const Run run{.seed = 1, .count = count, .server = broken_server("tiring")};
    CrowdTrial trial = row(run);
    trial.rounds = {.count = 1, .duration = std::chrono::seconds(3), .must_keep_up = true};
    trial.deadline = {}; // covered by another test
    return compare_with_baseline(run, trial);
}

constexpr auto kNotKeptUp = "(p99) with the crowd";

TEST(ViewersRow, DetectsLateAcknowledgements) {
    expect_found(keep_up_with_a_tiring_server(viewers_trial, 12), kNotKeptUp);
}

TEST(FloodRow, DetectsLateAcknowledgements) { expect_found(keep_up_with_a_tiring_server(flood_trial, 12), kNotKeptUp); }

std::unique_ptr<store::ScanLog> memory_log() { return std::make_unique<store::MemoryScanLog>(); }

TEST(LinkRow, DetectsDuplicates) {
    const Outcome outcome = run_link_row({.seed = 1, .count = 60}, {[] { return forgetful_log(memory_log()); }});
    EXPECT_GT(outcome.twice, 0U);
    EXPECT_TRUE(outcome.repeat);
}

/// Has the effect of flipped bits if frames had no checksums.
TEST(LinkRow, DetectsCorruptionWithValidChecksums) {
    const Outcome outcome = run_link_row({.seed = 1, .count = 100}, {memory_log, true});
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

} // namespace
} // namespace scanloom::fault

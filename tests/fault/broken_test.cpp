#include "tests/fault/broken_logs.hpp"
#include "tests/fault/corrupt_row.hpp"
#include "tests/fault/kill_row.hpp"
#include "tests/fault/link_row.hpp"
#include "tests/fault/power_row.hpp"
#include "tests/fault/stall_row.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <gtest/gtest.h>

/// The rows of faults on what is broken: a row that passes here shows nothing.
namespace scanloom::fault {
namespace {

ServerCommand broken_server(const std::string& kind) { return {SCANLOOM_BROKEN_SERVER, {kind}}; }

TEST(KillRow, FindsAServerThatAcknowledgesWhatIsNotDurable) {
    const Outcome outcome = run_kill_row({.seed = 1, .count = 10, .server = broken_server("hasty")});
    EXPECT_GT(outcome.lost, 0U);
    ASSERT_TRUE(outcome.repeat);
    EXPECT_EQ(*outcome.repeat, "./scanloom fault kill --seed 1 --count 10");
}

TEST(KillRow, FindsAServerThatAppliesTwice) {
    const Outcome outcome = run_kill_row({.seed = 1, .count = 10, .server = broken_server("forgetful")});
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

TEST(CorruptRow, FindsAServerThatServesWhatWasNeverStored) {
    const Outcome outcome = run_corrupt_row({.seed = 1, .count = 10, .server = broken_server("blind")});
    EXPECT_FALSE(outcome.digest_equal);
    EXPECT_TRUE(outcome.repeat);
}

TEST(PowerRow, FindsAServerWhoseDiskDoesNotSync) {
    const Outcome outcome = run_power_row({.seed = 1, .count = 5, .server = broken_server("unsynced")});
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

TEST(StallRow, FindsAServerThatAcknowledgesTooEarly) {
    const Outcome outcome = run_stall_row({.seed = 1, .count = 2, .server = broken_server("hasty")});
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

/// As no kill shows it: what the system was given, it has.
TEST(KillRow, SaysNothingOfADiskThatDoesNotSync) {
    EXPECT_TRUE(run_kill_row({.seed = 1, .count = 5, .server = broken_server("unsynced")}).passed());
}

std::unique_ptr<store::ScanLog> memory_log() { return std::make_unique<store::MemoryScanLog>(); }

TEST(LinkRow, FindsAServerThatAppliesTwice) {
    const Outcome outcome = run_link_row({.seed = 1, .count = 60}, {[] { return forgetful_log(memory_log()); }});
    EXPECT_GT(outcome.twice, 0U);
    EXPECT_TRUE(outcome.repeat);
}

/// As flipped bits were, if frames had no checksums.
TEST(LinkRow, FindsDamageThatTheServerCannotSee) {
    const Outcome outcome = run_link_row({.seed = 1, .count = 100}, {memory_log, true});
    EXPECT_FALSE(outcome.passed());
    EXPECT_TRUE(outcome.repeat);
}

} // namespace
} // namespace scanloom::fault

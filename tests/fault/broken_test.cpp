#include "tests/fault/kill_row.hpp"

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

} // namespace
} // namespace scanloom::fault

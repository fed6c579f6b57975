#include "tests/fault/row.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

/// The short form of every row: what `./scanloom fault ROW` runs.
namespace scanloom::fault {
namespace {

constexpr std::uint64_t kSeed = 1;

void run_short(std::string_view name) {
    const Row* row = find_row(name);
    ASSERT_NE(row, nullptr);
    const Outcome outcome = row->run({.seed = kSeed, .count = row->count_short});
    for (const auto& sentence : outcome.amiss) ADD_FAILURE() << sentence;
    EXPECT_EQ(outcome.lost, 0U);
    EXPECT_EQ(outcome.twice, 0U);
    EXPECT_TRUE(outcome.digest_equal);
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_GT(outcome.acknowledged, 0U) << "nothing was tried";
}

TEST(FaultRow, Simulation) { run_short("simulation"); }
TEST(FaultRow, KillNine) { run_short("kill"); }
TEST(FaultRow, SpoiledLinks) { run_short("link"); }
TEST(FaultRow, DamagedStores) { run_short("corrupt"); }
TEST(FaultRow, RestartsUnderManyRobots) { run_short("restart"); }
TEST(FaultRow, JumpingClocks) { run_short("clock"); }
TEST(FaultRow, PowerCuts) { run_short("power"); }
TEST(FaultRow, FullDisks) { run_short("disk"); }
TEST(FaultRow, FailingSyncs) { run_short("sync"); }
TEST(FaultRow, OutagesAndKilledRobots) { run_short("spool"); }
TEST(FaultRow, StallingDisks) { run_short("stall"); }
TEST(FaultRow, ViewersThatDoNotRead) { run_short("viewers"); }
TEST(FaultRow, Floods) { run_short("flood"); }
TEST(FaultRow, Greed) { run_short("greed"); }
TEST(FaultRow, Soak) { run_short("soak"); }

} // namespace
} // namespace scanloom::fault

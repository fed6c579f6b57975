#include "tests/fault/beside.hpp"
#include "tests/fault/row.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <stdexcept>

/// The short form of every row: what `./scanloom fault ROW` runs.
namespace scanloom::fault {
namespace {

constexpr std::uint64_t kSeed = 1;

Outcome short_form_of(std::string_view name) {
    const Row* row = find_row(name);
    if (row == nullptr) throw std::invalid_argument(fmt::format("there is no row {}", name));
    return row->run({.seed = kSeed, .count = row->count_short});
}

void expect_passed(const Outcome& outcome) {
    for (const auto& sentence : outcome.amiss) ADD_FAILURE() << sentence;
    EXPECT_EQ(outcome.lost, 0U);
    EXPECT_EQ(outcome.twice, 0U);
    EXPECT_TRUE(outcome.digest_equal);
    if (outcome.skipped) GTEST_SKIP() << *outcome.skipped;
    EXPECT_GT(outcome.acknowledged, 0U) << "nothing was tried";
}

void run_short(std::string_view name) { expect_passed(short_form_of(name)); }

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

/// What was sent to the other server is told apart.
TEST(FaultRow, Greed) {
    const Outcome outcome = short_form_of("greed");
    expect_passed(outcome);
    const PacedLoad::Robots others;
    const auto of_others = std::uint64_t{2} * others.count * others.rate * Rounds{}.duration.count();
    const auto beside_them = outcome.figures.at("scans_of_greed");
    const auto elsewhere = outcome.figures.at("scans_of_greed_elsewhere");
    EXPECT_GT(beside_them, 0U);
    EXPECT_GT(elsewhere, 0U);
    EXPECT_EQ(outcome.acknowledged, of_others + beside_them + elsewhere);
}

TEST(FaultRow, Soak) { run_short("soak"); }

} // namespace
} // namespace scanloom::fault

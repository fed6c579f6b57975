#include "tests/fault/row_short_form.hpp"

/// The rows that `./scanloom test --all` runs.
namespace scanloom::fault {
namespace {

TEST(OtherFaultRow, KillNine) { expect_passed(short_form_of("kill")); }
TEST(OtherFaultRow, SpoiledLinks) { expect_passed(short_form_of("link")); }
TEST(OtherFaultRow, RestartsUnderManyRobots) { expect_passed(short_form_of("restart")); }
TEST(OtherFaultRow, ServersOfOneDatabase) { expect_passed(short_form_of("nodes")); }
TEST(OtherFaultRow, Simulation) { expect_passed(short_form_of("simulation")); }
TEST(OtherFaultRow, DamagedStores) { expect_passed(short_form_of("corrupt")); }
TEST(OtherFaultRow, JumpingClocks) { expect_passed(short_form_of("clock")); }
TEST(OtherFaultRow, PowerCuts) { expect_passed(short_form_of("power")); }
TEST(OtherFaultRow, FullDisks) { expect_passed(short_form_of("disk")); }
TEST(OtherFaultRow, FailingSyncs) { expect_passed(short_form_of("sync")); }
TEST(OtherFaultRow, OutagesAndKilledRobots) { expect_passed(short_form_of("spool")); }
TEST(OtherFaultRow, StallingDisks) { expect_passed(short_form_of("stall")); }
TEST(OtherFaultRow, Soak) { expect_passed(short_form_of("soak")); }

} // namespace
} // namespace scanloom::fault

#include "tests/fault/row_short_form.hpp"

/// Kills, spoiled connections and restarts. Every `./scanloom test` runs a third of the short form of each row.
namespace scanloom::fault {
namespace {

TEST(MainFaultRow, KillNine) { expect_passed(short_form_of("kill", 3)); }
TEST(MainFaultRow, SpoiledLinks) { expect_passed(short_form_of("link", 3)); }
TEST(MainFaultRow, RestartsUnderManyRobots) { expect_passed(short_form_of("restart", 3)); }

} // namespace
} // namespace scanloom::fault

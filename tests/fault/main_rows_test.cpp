#include "tests/fault/row_short_form.hpp"

/// The rows that every `./scanloom test` runs: kills, spoiled connections and restarts.
namespace scanloom::fault {
namespace {

TEST(MainFaultRow, KillNine) { expect_passed(short_form_of("kill")); }
TEST(MainFaultRow, SpoiledLinks) { expect_passed(short_form_of("link")); }
TEST(MainFaultRow, RestartsUnderManyRobots) { expect_passed(short_form_of("restart")); }

} // namespace
} // namespace scanloom::fault

#include "tests/fault/crowd_rows.hpp"
#include "tests/fault/row_short_form.hpp"

/// Rows that compare latencies. They need a quiet machine, so only `./scanloom test --nightly` runs them.
namespace scanloom::fault {
namespace {

TEST(TimedFaultRow, ViewersThatDoNotRead) { expect_passed(short_form_of("viewers")); }
TEST(TimedFaultRow, Floods) { expect_passed(short_form_of("flood")); }

/// The figures count scans sent to the other server separately.
TEST(TimedFaultRow, Greed) {
    const Outcome outcome = short_form_of("greed");
    expect_passed(outcome);
    const PacedLoad::Robots others;
    const auto of_others = std::uint64_t{2} * others.count * others.rate * Rounds{}.duration.count();
    const auto to_this_server = outcome.figures.at("scans_of_greed");
    const auto elsewhere = outcome.figures.at("scans_of_greed_elsewhere");
    EXPECT_GT(to_this_server, 0U);
    EXPECT_GT(elsewhere, 0U);
    EXPECT_EQ(outcome.acknowledged, of_others + to_this_server + elsewhere);
}

} // namespace
} // namespace scanloom::fault

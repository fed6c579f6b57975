#include "tests/fault/beside.hpp"
#include "tests/fault/paced_load.hpp"
#include "tests/fault/paces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// How the rows viewers, flood and greed evaluate the acknowledgement latency of robots.
namespace scanloom::fault {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

Outcome outcome_of(const Paces& paces, bool must_keep_up = true) {
    Outcome outcome;
    check_paces(paces, must_keep_up, outcome);
    return outcome;
}

TEST(Paces, TwiceAsLongAsInPeaceIsLongEnough) {
    EXPECT_THAT(outcome_of({.in_peace = {2.0}, .beside = {4.0}}).amiss, IsEmpty());
    EXPECT_THAT(outcome_of({.in_peace = {2.0}, .beside = {4.1}}).amiss,
                ElementsAre("acknowledgements took 4.1 ms (p99) beside the crowd, 2.0 ms in peace"));
}

TEST(Paces, TheShortFormTellsThemOnly) {
    const Outcome outcome = outcome_of({.in_peace = {2.0}, .beside = {400.0}}, false);
    EXPECT_THAT(outcome.amiss, IsEmpty());
    EXPECT_THAT(outcome.figures, UnorderedElementsAre(Pair("p99_in_peace_us", 2'000), Pair("p99_beside_us", 400'000)));
}

TEST(Paces, TheMedianOfTheRoundsCounts) {
    const Outcome outcome =
        outcome_of({.alone = {1.0, 0.5, 9.0}, .in_peace = {90.0, 2.0, 3.0}, .beside = {6.1, 900.0, 1.0}});
    EXPECT_THAT(outcome.amiss, ElementsAre(HasSubstr("6.1 ms (p99) beside the crowd, 3.0 ms in peace")));
    EXPECT_THAT(outcome.figures, UnorderedElementsAre(Pair("p99_alone_us", 1'000), Pair("p99_in_peace_us", 3'000),
                                                      Pair("p99_beside_us", 6'100)));
}

TEST(Paces, AFigureThatIsMissingIsAmiss) {
    const auto is_missing = ElementsAre("not every round tells how soon its robots were acknowledged");
    EXPECT_THAT(outcome_of({.in_peace = {2.0, {}, 2.0}, .beside = {2.0, 2.0, 2.0}}).amiss, is_missing);
    EXPECT_THAT(outcome_of({.in_peace = {2.0, 2.0, 2.0}, .beside = {2.0, {}, 2.0}}).amiss, is_missing);
    EXPECT_THAT(outcome_of({.alone = {{}}, .in_peace = {2.0}, .beside = {2.0}}).amiss, is_missing);
    EXPECT_THAT(outcome_of({}).amiss, is_missing);
    EXPECT_THAT(outcome_of({.in_peace = {2.0}, .beside = {{}}}, false).amiss, is_missing) << "in the short form, too";
}

TEST(Paces, CountInTheLongFormsOfAllThreeRows) {
    for (const auto& row : {beside_viewers, beside_flood, beside_greed}) {
        const Beside of_long = row({.is_long = true}); // of any count
        EXPECT_TRUE(of_long.rounds.must_keep_up);
        EXPECT_EQ(of_long.rounds.count, 3U);
        EXPECT_FALSE(row({.count = 1'000}).rounds.must_keep_up)
            << "three seconds on a machine of others tell too little";
    }
    EXPECT_TRUE(beside_greed({.is_long = true}).is_tried_alone);
}

std::string report_with(const std::string& latencies) {
    return R"({"scans": {"acknowledged": 6, "lost": 0}, "verdict": {"nothing_lost": true, "sentence": "all there"})" +
           latencies + "}";
}

TEST(PacedLoad, ItsPaceIsThatFromWhenEachScanWasMeantToBeSent) {
    const auto report = PacedLoad::read_report(
        report_with(
            R"(, "ack_from_sending": {"count": 6, "p99_ms": 1.5}, "ack_from_intended": {"count": 6, "p99_ms": 2.5})"),
        0);
    EXPECT_EQ(report.p99_ms, 2.5);
    EXPECT_EQ(report.outcome.acknowledged, 6U);
    EXPECT_TRUE(report.outcome.passed());
}

TEST(PacedLoad, HasNoPaceWhereItsReportDoesNotTell) {
    EXPECT_EQ(PacedLoad::read_report(report_with(""), 0).p99_ms, std::nullopt);
    EXPECT_EQ(PacedLoad::read_report(report_with(R"(, "ack_from_intended": {"count": 0, "p99_ms": 0.0})"), 0).p99_ms,
              std::nullopt)
        << "no scan was acknowledged";
}

TEST(PacedLoad, WithoutAReportIsAmiss) {
    const auto report = PacedLoad::read_report("", -6);
    EXPECT_EQ(report.p99_ms, std::nullopt);
    EXPECT_THAT(report.outcome.amiss, ElementsAre("scanloom-load ended with -6 and no report"));
}

} // namespace
} // namespace scanloom::fault

#include "tests/fault/ack_latency.hpp"
#include "tests/fault/crowd_rows.hpp"
#include "tests/fault/paced_load.hpp"

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

Outcome outcome_of(const AckLatency& paces, bool must_keep_up = true) {
    Outcome outcome;
    check_latency(paces, must_keep_up, outcome);
    return outcome;
}

TEST(AckLatency, AllowsTwiceTheBaseline) {
    EXPECT_THAT(outcome_of({.baseline = {2.0}, .with_crowd = {4.0}}).failures, IsEmpty());
    EXPECT_THAT(outcome_of({.baseline = {2.0}, .with_crowd = {4.1}}).failures,
                ElementsAre("acknowledgements took 4.1 ms (p99) with the crowd, 2.0 ms without it"));
}

TEST(AckLatency, IsReportedButNotCheckedInTheShortForm) {
    const Outcome outcome = outcome_of({.baseline = {2.0}, .with_crowd = {400.0}}, false);
    EXPECT_THAT(outcome.failures, IsEmpty());
    EXPECT_THAT(outcome.figures,
                UnorderedElementsAre(Pair("p99_baseline_us", 2'000), Pair("p99_with_crowd_us", 400'000)));
}

TEST(AckLatency, UsesTheMedianOfTheRounds) {
    const Outcome outcome =
        outcome_of({.alone = {1.0, 0.5, 9.0}, .baseline = {90.0, 2.0, 3.0}, .with_crowd = {6.1, 900.0, 1.0}});
    EXPECT_THAT(outcome.failures, ElementsAre(HasSubstr("6.1 ms (p99) with the crowd, 3.0 ms without it")));
    EXPECT_THAT(outcome.figures, UnorderedElementsAre(Pair("p99_alone_us", 1'000), Pair("p99_baseline_us", 3'000),
                                                      Pair("p99_with_crowd_us", 6'100)));
}

TEST(AckLatency, FailsIfARoundReportsNone) {
    const auto is_missing = ElementsAre("a round did not report the latency of its acknowledgements");
    EXPECT_THAT(outcome_of({.baseline = {2.0, {}, 2.0}, .with_crowd = {2.0, 2.0, 2.0}}).failures, is_missing);
    EXPECT_THAT(outcome_of({.baseline = {2.0, 2.0, 2.0}, .with_crowd = {2.0, {}, 2.0}}).failures, is_missing);
    EXPECT_THAT(outcome_of({.alone = {{}}, .baseline = {2.0}, .with_crowd = {2.0}}).failures, is_missing);
    EXPECT_THAT(outcome_of({}).failures, is_missing);
    EXPECT_THAT(outcome_of({.baseline = {2.0}, .with_crowd = {{}}}, false).failures, is_missing)
        << "in the short form, too";
}

TEST(AckLatency, IsCheckedInTheLongFormsOfAllThreeRows) {
    for (const auto& row : {viewers_trial, flood_trial, greed_trial}) {
        const CrowdTrial of_long = row({.is_long = true}); // of any count
        EXPECT_TRUE(of_long.rounds.must_keep_up);
        EXPECT_EQ(of_long.rounds.count, 3U);
        EXPECT_FALSE(row({.count = 1'000}).rounds.must_keep_up) << "three seconds on a shared machine are too short";
    }
    EXPECT_TRUE(greed_trial({.is_long = true}).is_tried_alone);
}

std::string report_with(const std::string& latencies) {
    return R"({"scans": {"acknowledged": 6, "lost": 0}, "verdict": {"nothing_lost": true, "sentence": "all there"})" +
           latencies + "}";
}

TEST(PacedLoad, MeasuresLatencyFromTheIntendedSendTime) {
    const auto report = PacedLoad::read_report(
        report_with(
            R"(, "ack_from_sending": {"count": 6, "p99_ms": 1.5}, "ack_from_intended": {"count": 6, "p99_ms": 2.5})"),
        0);
    EXPECT_EQ(report.p99_ms, 2.5);
    EXPECT_EQ(report.outcome.acknowledged, 6U);
    EXPECT_TRUE(report.outcome.passed());
}

TEST(PacedLoad, HasNoLatencyIfItsReportHasNone) {
    EXPECT_EQ(PacedLoad::read_report(report_with(""), 0).p99_ms, std::nullopt);
    EXPECT_EQ(PacedLoad::read_report(report_with(R"(, "ack_from_intended": {"count": 0, "p99_ms": 0.0})"), 0).p99_ms,
              std::nullopt)
        << "no scan was acknowledged";
}

TEST(PacedLoad, FailsWithoutAReport) {
    const auto report = PacedLoad::read_report("", -6);
    EXPECT_EQ(report.p99_ms, std::nullopt);
    EXPECT_THAT(report.outcome.failures, ElementsAre("scanloom-load ended with -6 and no report"));
}

} // namespace
} // namespace scanloom::fault

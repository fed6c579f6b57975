#include "lab/landmark_findings.hpp"

#include "tests/unit/lab/drawn_landmark_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

std::string placement_of(const std::vector<double>& values) { return placed(values, {0.18, 0.49}); }

TEST(LandmarkFindings, ValuesAreComparedAsPrinted) {
    EXPECT_EQ(placement_of({0.18, 0.494}), "within");
    EXPECT_EQ(placement_of({0.496}), "above");
    EXPECT_EQ(placement_of({0.1, 0.17}), "below");
    EXPECT_EQ(placement_of({0.1, 0.3}), "partly outside");
    EXPECT_EQ(placement_of({0.3, 0.9}), "partly outside");
}

TEST(LandmarkFindings, ExplainOnlyValuesOutsideThePublishedRange) {
    auto results = drawn_landmark_results();
    auto findings = door_findings(results);
    ASSERT_EQ(findings.size(), 3U);
    EXPECT_THAT(findings[0], HasSubstr("Persistence is 0.50, above the published 0.18 to 0.49: "));
    EXPECT_THAT(findings[0], HasSubstr("Without a moved door it is 1.00"));
    EXPECT_THAT(findings[0], HasSubstr("to the next place it is 0.25"));
    EXPECT_EQ(findings[1], "Stability is 0.75, within the published 0.67 to 0.89.");
    EXPECT_THAT(findings[2], HasSubstr("Continuity is 0.70, above the published 0.43 to 0.46: fill is 1.00"));
    results.places[0].door.comparison.metrics.stability.reset();
    EXPECT_THAT(door_findings(results)[1], HasSubstr("cannot be computed"));
}

TEST(LandmarkFindings, DistancesAreComparedWithPublishedOnes) {
    auto results = drawn_landmark_results();
    EXPECT_THAT(tolerance_finding(results), HasSubstr("the mean distance is 0.020 m, above the published 0.018 m"));
    EXPECT_THAT(tolerance_finding(results), HasSubstr("deviation 0.013 m, equal to the published 0.013 m"));
    results.tolerances[0].metrics = {};
    EXPECT_THAT(tolerance_finding(results), HasSubstr("no landmarks match"));
}

TEST(LandmarkFindings, CornersAreRoundedIfTheirErrorExceedsTheUnfilteredOne) {
    const auto row = [](std::size_t window, double wall, double corner) { return FilterRow{window, {}, wall, corner}; };
    const std::vector<FilterRow> rows{row(1, 0.015, 0.018), row(3, 0.010, 0.018), row(5, 0.012, 0.020),
                                      row(7, 0.012, 0.036), row(9, 0.013, 0.5)};
    const auto finding = window_finding(rows);
    EXPECT_THAT(finding, HasSubstr("a window of 3 is best: 0.010 m instead of 0.015 m"));
    EXPECT_THAT(finding, HasSubstr("Corners are rounded from a window of 5, where their error is 0.020 m"));
    EXPECT_THAT(finding, HasSubstr("from 7 it is more than twice as large; with 9 it is 0.50 m"));
    EXPECT_THAT(window_finding({row(1, 0.015, 0.018), row(3, 0.010, 0.018)}),
                HasSubstr("No window increases the error"));
}

TEST(LandmarkFindings, RecordingHalvesAreComparedWithPublishedValues) {
    const auto results = drawn_landmark_results();
    EXPECT_THAT(recording_finding(*results.recorded),
                HasSubstr("Persistence is 0.50, above the published 0.18 to 0.49; stability is 0.75, within"));
}

} // namespace
} // namespace scanloom::lab

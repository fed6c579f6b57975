#include "lab/report.hpp"

#include "lab/markdown.hpp"

#include "tests/unit/lab/drawn_landmark_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(LandmarkReport, TablesContainTheFigures) {
    const auto text = report_of(drawn_landmark_results());
    EXPECT_THAT(text,
                HasSubstr("| 1 | opened | 4 | 4 | 2 | 0.50 | 0.75 | 0.020 | 0.013 | 0.80 | 0.30 | 1.00 | 0.70 |"));
    EXPECT_THAT(text, HasSubstr("| 1 | closed in both | 4 | 4 | 2 | 1.00 |"));
    EXPECT_THAT(text, HasSubstr("| published |  |  |  |  | 0.18 to 0.49 | 0.67 to 0.89 |"));
    EXPECT_THAT(text, HasSubstr("| 1 to 2 | closed in both | 4 | 4 | 2 | 0.25 |"));
    EXPECT_THAT(text, HasSubstr("| 0.1 | 4 | 0.50 | 0.75 | 0.020 | 0.013 |"));
    EXPECT_THAT(text, HasSubstr("| published, 0.1 |  |  |  | 0.018 | 0.013 |"));
    EXPECT_THAT(text, HasSubstr("| 50 | 18000 | 0.150 | 9 | 74941 | 1166716 |"));
    EXPECT_THAT(text, HasSubstr("| 1 | 0.000 | 0.00 | - | 0.015 | 0.018 |")) << "an absent value is a dash";
    EXPECT_THAT(text, HasSubstr("1 at (1.5, -2) m"));
    EXPECT_THAT(text, HasSubstr("Seed: 7."));
    EXPECT_THAT(text, HasSubstr("(pictures/p.png)"));
}

TEST(LandmarkReport, ContainsTheRecordingIfPresent) {
    auto results = drawn_landmark_results();
    const auto with = report_of(results);
    EXPECT_THAT(with, HasSubstr("--seed 7 --capture c.bin"));
    EXPECT_THAT(with, HasSubstr("| whole | 9 | 11 |"));
    EXPECT_THAT(with, HasSubstr("| first half | 4 |"));
    EXPECT_THAT(with, HasSubstr("| second half | 5 |"));
    EXPECT_THAT(with, HasSubstr("(pictures/r.png)"));
    results.recorded.reset();
    const auto without = report_of(results);
    EXPECT_THAT(without, Not(HasSubstr("--capture")));
    EXPECT_THAT(without, Not(HasSubstr("A recording")));
}

TEST(LandmarkReport, IsIndependentOfTimes) {
    auto results = drawn_landmark_results();
    const auto text = to_html(report_of(results));
    const auto times = times_report_of(results, "a PDP-11");
    EXPECT_THAT(times, HasSubstr("| 50 | 18000 | 6.50 | 361 |"));
    EXPECT_THAT(times, HasSubstr("Measured on: a PDP-11."));
    results.readings[0].milliseconds = 1.0;
    EXPECT_EQ(to_html(report_of(results)), text);
    EXPECT_NE(times_report_of(results, "a PDP-11"), times);
}

} // namespace
} // namespace scanloom::lab

#include "lab/markdown.hpp"
#include "lab/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;
using testing::Not;

TrajectoryScore score_of(double metres, double degrees, std::size_t used = 40) {
    TrajectoryScore score{.used = used, .missing = 2};
    score.translation.absolute = {metres, 0.5 * metres};
    score.rotation.absolute = {degrees, 2.0 * degrees};
    return score;
}

/// Returns results of one log with three variants, the last one with a false loop.
LocalizationResults drawn_results(const std::string& name) {
    LogResult log{.name = name, .scans = 1000, .seconds = 99.6, .path = 123.4, .odometry = score_of(7.5, 12.0)};
    log.with_odometry = {score_of(0.02, 0.25), score_of(0.05, 0.5), 3, 0.5};
    log.without = {score_of(0.03, 0.375), score_of(0.06, 0.75), 4, 0.75};
    log.without_from_plain = {0.125, 2.5, 0};
    const auto variant = [](double scale, std::size_t skip) {
        return Variant{Poses::kOdometry, {.odometry_scale = scale, .skip = skip}};
    };
    log.variants = {{variant(0.97, 0), score_of(0.03, 0.25), 1.5, {0.25, 10.0, 7}},
                    {variant(1.01, 50), std::nullopt, 0.0, {0.5, 15.0, 8}},
                    {{Poses::kNone, {.skip = 150}}, score_of(0.025, 0.25, 30), 1.125, {0.75, 5.0, 0}}};
    log.unknown_starts = {{Poses::kOdometry, 0.3, UnknownStart::Found{120, 24.6, 0.044, 0.16}},
                          {Poses::kNone, 0.8, std::nullopt}};
    log.maps = {DrawnMap{"a.png", 0.1, 94.1, 75.2}, {"b.png", 0.05, 39.4, 36.0}, {"c.png", 0.05, 39.0, 36.0}};
    return {{{"/data/" + name + ".clf.bz2", "/data/" + name + ".relations"}}, {log}};
}

TEST(LocalizationReport, TablesContainTheFigures) {
    const auto text = report_of(drawn_results("hall"));
    EXPECT_THAT(text, HasSubstr("localization --out docs/localization hall.clf.bz2 hall.relations\n"));
    EXPECT_THAT(text, Not(HasSubstr("/data/")));
    EXPECT_THAT(text, HasSubstr("| hall | 1000 | 100 | 123 | 42 |"));
    EXPECT_THAT(text, HasSubstr("| hall | raw odometry | 7.5000 | 3.7500 | 12.000 | 24.000 |  |\n"
                                "| hall | with odometry, final | 0.0200 | 0.0100 | 0.250 | 0.500 | 3 |\n"
                                "| hall | with odometry, first | 0.0500 | 0.0250 | 0.500 | 1.000 |  |\n"
                                "| hall | without odometry, final | 0.0300 | 0.0150 | 0.375 | 0.750 | 4 |\n"
                                "| hall | without odometry, first | 0.0600 | 0.0300 | 0.750 | 1.500 |  |\n\n"));
    EXPECT_THAT(text, HasSubstr("- hall: without odometry, the final poses are at most 0.12 m and 2.5 degrees from"));
    EXPECT_THAT(
        text, HasSubstr("| plain | 40 | 0.0200 |  |  |  |  |  |\n"
                        "| odometry x 0.97 | 40 | 0.0300 | 1.50 | 0.25 | 10.0 | 7 | no |\n"
                        "| odometry x 1.01, without the first 50 scans | 0 | - | - | 0.50 | 15.0 | 8 | no |\n"
                        "| no odometry, without the first 150 scans | 30 | 0.0250 | 1.12 | 0.75 | 5.0 | 0 | yes |\n"));
}

TEST(LocalizationReport, NamesTheWorstVariantsAndCountsFalseLoops) {
    EXPECT_THAT(report_of(drawn_results("hall")),
                HasSubstr("1 of 3 variants have a false loop; the worst error is 1.50 times that of the plain estimate "
                          "for the same relations (odometry x 0.97), the largest distance 0.75 m (no odometry, without "
                          "the first 150 scans), "
                          "the largest turn 15.0 degrees (odometry x 1.01, without the first 50 scans)."));
}

TEST(LocalizationReport, ShowsWhenASecondRobotIsLocated) {
    EXPECT_THAT(report_of(drawn_results("hall")), HasSubstr("| hall | odometry | 30 % | 120 | 25 | 0.04 | 0.2 |\n"
                                                            "| hall | none | 80 % | not located |  |  |  |"));
}

TEST(LocalizationReport, ShowsTheMapsSideBySide) {
    const auto results = drawn_results("hall");
    EXPECT_THAT(report_of(results), HasSubstr("| raw odometry | with odometry | without odometry |\n"
                                              "| --- | --- | --- |\n"
                                              "| ![map of hall, raw odometry](pictures/a.png) | ![map of hall, with "
                                              "odometry](pictures/b.png) | ![map of hall, without "
                                              "odometry](pictures/c.png) |\n"
                                              "| 94 x 75 m, cells of 0.1 m | 39 x 36 m, cells of 0.05 m | "
                                              "39 x 36 m, cells of 0.05 m |"));
    EXPECT_THAT(to_html(report_of(results)), HasSubstr("<td><a href=\"pictures/b.png\"><img src=\"pictures/b.png\""));
}

TEST(LocalizationReport, OnlyPublicLogsHavePublishedFiguresAndCredits) {
    const auto intel = report_of(drawn_results("intel"));
    EXPECT_THAT(intel, HasSubstr("| intel | published: graph mapping, 2009 | 0.031 |  |  |  |  |\n"
                                 "| intel | published: Cartographer, 2016 | 0.0229 |"));
    EXPECT_THAT(intel, HasSubstr("recorded by D. Haehnel"));
    const auto fr079 = report_of(drawn_results("fr079"));
    EXPECT_THAT(fr079, HasSubstr("| fr079 | published: graph mapping, 2009 | 0.056 |  |  |  |  |\n"
                                 "| fr079 | published: Cartographer, 2016 | 0.0452 |"));
    EXPECT_THAT(fr079, HasSubstr("recorded by C. Stachniss"));
    for (const char* name : {"hall", "intel-corrected", "Intel2"}) {
        const auto other = report_of(drawn_results(name));
        EXPECT_THAT(other, Not(HasSubstr("published:"))) << name;
        EXPECT_THAT(other, Not(HasSubstr("recorded by"))) << name;
    }
}

TEST(LocalizationReport, IsIndependentOfTimes) {
    auto results = drawn_results("hall");
    const auto text = to_html(report_of(results));
    const auto times = times_report_of(results, "a PDP-11");
    EXPECT_THAT(times, HasSubstr("| hall | with odometry | 1000 | 0.50 | 0.500 |\n"
                                 "| hall | without odometry | 1000 | 0.75 | 0.750 |"));
    EXPECT_THAT(times, HasSubstr("Measured on: a PDP-11."));
    results.logs[0].with_odometry.cpu_seconds = 2.0;
    EXPECT_EQ(to_html(report_of(results)), text);
    EXPECT_NE(times_report_of(results, "a PDP-11"), times);
}

} // namespace
} // namespace scanloom::lab

#include "lab/score_report.hpp"

#include "lab/estimated_trajectory.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

ScoreOptions example_options() {
    ScoreOptions options;
    options.log = "a \"b\".clf";
    options.relations = "a.relations";
    options.perturbation = {.odometry_scale = 1.03, .skip = 5, .every = 2};
    return options;
}

ScoreResult example_result() {
    ScoreResult result{.scans = 1000, .skipped_lines = 3, .cpu_seconds = 0.5};
    result.final_poses = {.used = 20, .missing = 2, .left_out = 8};
    result.final_poses.translation = {{0.0151, 0.0113}, {0.0004, 0.0014}};
    result.final_poses.rotation = {{0.25, 0.125}, {0.1, 0.3}};
    result.first_poses = result.final_poses;
    result.first_poses.translation.absolute.mean = 1.75;
    return result;
}

TEST(ScoreReport, JsonHasTheFiguresOfBothTrajectories) {
    const std::string text = score_json(example_options(), example_result());
    EXPECT_EQ(text.find('\n'), std::string::npos);
    const auto json = boost::json::parse(text).as_object();
    EXPECT_EQ(json.at("log"), "a \"b\".clf");
    EXPECT_EQ(json.at("poses"), "odometry");
    EXPECT_EQ(json.at("odometry_scale").as_double(), 1.03);
    EXPECT_EQ(json.at("every"), 2);
    EXPECT_EQ(json.at("skip"), 5);
    EXPECT_EQ(json.at("scans"), 1000);
    EXPECT_EQ(json.at("skipped_lines"), 3);
    EXPECT_EQ(json.at("cpu_seconds").as_double(), 0.5);
    EXPECT_EQ(json.at("ms_per_scan").as_double(), 0.5);
    EXPECT_EQ(json.at("relations").at("used"), 20);
    EXPECT_EQ(json.at("relations").at("missing"), 2);
    EXPECT_EQ(json.at("relations").at("left_out"), 8);
    EXPECT_EQ(json.at("final").at("translation_m").at("mean").as_double(), 0.0151);
    EXPECT_EQ(json.at("final").at("translation_m").at("std").as_double(), 0.0113);
    EXPECT_EQ(json.at("final").at("translation_m").at("squared_std").as_double(), 0.0014);
    EXPECT_EQ(json.at("final").at("rotation_deg").at("mean").as_double(), 0.25);
    EXPECT_EQ(json.at("final").at("rotation_deg").at("squared_mean").as_double(), 0.1);
    EXPECT_EQ(json.at("first").at("translation_m").at("mean").as_double(), 1.75);
}

TEST(ScoreReport, JsonNamesTheUseOfPoses) {
    ScoreOptions options = example_options();
    options.poses = Poses::kNone;
    EXPECT_THAT(score_json(options, example_result()), HasSubstr(R"("poses":"none")"));
}

TEST(ScoreReport, TableHasARowForEachTrajectory) {
    const std::string table = score_table(example_options(), example_result());
    EXPECT_THAT(table, HasSubstr("1000 scans"));
    EXPECT_THAT(table, HasSubstr("0.500 ms per scan"));
    EXPECT_THAT(table, HasSubstr("20 relations used, 2 outside the trajectory, 8 of scans that were left out"));
    EXPECT_THAT(table, HasSubstr("\nfinal poses    0.0151 +- 0.0113     0.250 +- 0.125\n"));
    EXPECT_THAT(table, HasSubstr("\nfirst poses    1.7500 +- 0.0113"));
}

TEST(TumText, HasALineForEachPoseByStamp) {
    const std::vector<robot::StampedPose> poses{{{1.5, -2, std::numbers::pi}, 976052857.3375301}, {{0, 0.25, 0}, 3.0}};
    EXPECT_EQ(tum_text(poses), "3.000000 0.000000 0.250000 0 0 0 0.000000000 1.000000000\n"
                               "976052857.337530 1.500000 -2.000000 0 0 0 1.000000000 0.000000000\n");
    EXPECT_EQ(tum_text({}), "");
}

} // namespace
} // namespace scanloom::lab

#include "lab/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

std::variant<ExperimentOptions, LandmarkOptions, ScoreOptions, Leave> parse(const std::vector<const char*>& words) {
    std::vector<const char*> argv{"scanloom-lab"};
    argv.insert(argv.end(), words.begin(), words.end());
    return parse_options(static_cast<int>(argv.size()), argv.data());
}

TEST(LabOptionsTest, ExperimentHasADirectoryAndDefaults) {
    const auto options = std::get<ExperimentOptions>(parse({"experiment", "--out", "d"}));
    EXPECT_EQ(options.out, "d");
    EXPECT_EQ(options.seed, 1U);
    EXPECT_FALSE(options.quick || options.scans);
    const auto other =
        std::get<ExperimentOptions>(parse({"experiment", "--quick", "--seed", "7", "--scans=50", "--out", "d"}));
    EXPECT_TRUE(other.quick);
    EXPECT_EQ(other.seed, 7U);
    EXPECT_EQ(other.scans, 50U);
}

TEST(LabOptionsTest, LandmarksHasADirectoryASeedAndARecording) {
    const auto options = std::get<LandmarkOptions>(parse({"landmarks", "--out", "d"}));
    EXPECT_EQ(options.out, "d");
    EXPECT_EQ(options.seed, 1U);
    EXPECT_FALSE(options.capture);
    const auto other = std::get<LandmarkOptions>(
        parse({"landmarks", "--seed", "7", "--scenes", "0", "--capture", "c.bin", "--out", "d"}));
    EXPECT_EQ(other.seed, 7U);
    EXPECT_EQ(other.capture, "c.bin");
}

TEST(LabOptionsTest, ScoreHasTwoFilesAndDefaults) {
    const auto options = std::get<ScoreOptions>(parse({"score", "a.clf", "a.relations"}));
    EXPECT_EQ(options.log, "a.clf");
    EXPECT_EQ(options.relations, "a.relations");
    EXPECT_EQ(options.poses, Poses::kOdometry);
    EXPECT_FALSE(options.trajectory);
    EXPECT_EQ(options.perturbation.odometry_scale, 1.0);
    EXPECT_FALSE(options.perturbation.drops_scans());
    const auto other = std::get<ScoreOptions>(parse({"score", "a.clf", "a.relations", "--poses", "none", "--trajectory",
                                                     "t.tum", "--every", "2", "--skip", "100"}));
    EXPECT_EQ(other.poses, Poses::kNone);
    EXPECT_EQ(other.trajectory, "t.tum");
    EXPECT_EQ(other.perturbation.every, 2U);
    EXPECT_EQ(other.perturbation.skip, 100U);
    const auto scaled = std::get<ScoreOptions>(parse({"score", "a.clf", "a.relations", "--odometry-scale", "1.03"}));
    EXPECT_EQ(scaled.perturbation.odometry_scale, 1.03);
}

TEST(LabOptionsTest, InvalidOptionIsAOneLineUsageError) {
    const std::vector<std::pair<std::vector<const char*>, const char*>> mistakes{
        {{}, "name a command: experiment, landmarks or score"},
        {{"experiment"}, "experiment: name a directory with --out"},
        {{"experiment", "--out", "d", "--scans", "9"}, "--scans"},
        {{"experiment", "--out", "d", "--scans", "10.5"}, "--scans"},
        {{"experiment", "--out", "d", "--seed", "-1"}, "--seed"},
        {{"experiment", "--out", "d", "--bogus"}, "--bogus"},
        {{"landmark"}, "name a command: experiment, landmarks or score"},
        {{"landmarks"}, "landmarks: name a directory with --out"},
        {{"landmarks", "--out", "d", "--seed", "-1"}, "--seed"},
        {{"landmarks", "--out", "d", "--capture", ""}, "--capture"},
        {{"landmarks", "--out", "d", "--quick"}, "--quick"},
        {{"experiment", "--out", "d", "--capture", "c.bin"}, "--capture"},
        {{"score"}, "score: name two files, LOG and RELATIONS"},
        {{"score", "a"}, "score: name two files, LOG and RELATIONS"},
        {{"score", "a", "b", "--poses", "map"}, "--poses"},
        {{"score", "a", "b", "--every", "0"}, "--every"},
        {{"score", "a", "b", "--skip", "-1"}, "--skip"},
        {{"score", "a", "b", "--odometry-scale", "2.1"}, "--odometry-scale"},
        {{"score", "a", "b", "--odometry-scale", "nan"}, "--odometry-scale"},
        {{"score", "a", "b", "--trajectory", ""}, "--trajectory"},
        {{"score", "a", "b", "--poses", "none", "--odometry-scale", "1.1"}, "--odometry-scale has no effect"},
    };
    for (const auto& [words, hint] : mistakes) {
        const auto leave = std::get<Leave>(parse(words));
        EXPECT_EQ(leave.code, kExitUsage);
        EXPECT_THAT(leave.text, HasSubstr(hint));
        EXPECT_THAT(leave.text, HasSubstr("scanloom-lab --help"));
        EXPECT_EQ(std::count(leave.text.begin(), leave.text.end(), '\n'), 1) << leave.text;
    }
}

TEST(LabOptionsTest, HelpAndVersionAreNotErrors) {
    EXPECT_EQ(std::get<Leave>(parse({"--help"})).code, kExitDone);
    EXPECT_THAT(std::get<Leave>(parse({"--help"})).text, HasSubstr("experiment"));
    EXPECT_THAT(std::get<Leave>(parse({"--help"})).text, HasSubstr("landmarks"));
    EXPECT_THAT(std::get<Leave>(parse({"score", "--help"})).text, HasSubstr("--odometry-scale"));
    EXPECT_EQ(std::get<Leave>(parse({"landmarks", "--help"})).code, kExitDone);
    EXPECT_THAT(std::get<Leave>(parse({"landmarks", "--help"})).text, HasSubstr("--capture"));
    EXPECT_THAT(std::get<Leave>(parse({"--version"})).text, HasSubstr("scanloom-lab "));
}

} // namespace
} // namespace scanloom::lab

#include "lab/options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace scanloom::lab {
namespace {

using testing::HasSubstr;

std::variant<Options, Leave> parse(const std::vector<const char*>& words) {
    std::vector<const char*> argv{"scanloom-lab"};
    argv.insert(argv.end(), words.begin(), words.end());
    return parse_options(static_cast<int>(argv.size()), argv.data());
}

template <class Chosen>
Chosen options_of(const std::vector<const char*>& words) {
    return std::get<Chosen>(std::get<Options>(parse(words)));
}

TEST(LabOptionsTest, ExperimentHasADirectoryAndDefaults) {
    const auto options = options_of<ExperimentOptions>({"experiment", "--out", "d"});
    EXPECT_EQ(options.out, "d");
    EXPECT_EQ(options.seed, 1U);
    EXPECT_FALSE(options.quick || options.scans);
    const auto other =
        options_of<ExperimentOptions>({"experiment", "--quick", "--seed", "7", "--scans=50", "--out", "d"});
    EXPECT_TRUE(other.quick);
    EXPECT_EQ(other.seed, 7U);
    EXPECT_EQ(other.scans, 50U);
}

TEST(LabOptionsTest, LandmarksHasADirectoryASeedAndARecording) {
    const auto options = options_of<LandmarkOptions>({"landmarks", "--out", "d"});
    EXPECT_EQ(options.out, "d");
    EXPECT_EQ(options.seed, 1U);
    EXPECT_FALSE(options.capture);
    const auto other =
        options_of<LandmarkOptions>({"landmarks", "--seed", "7", "--scenes", "0", "--capture", "c.bin", "--out", "d"});
    EXPECT_EQ(other.seed, 7U);
    EXPECT_EQ(other.capture, "c.bin");
}

TEST(LabOptionsTest, ScoreHasTwoFilesAndDefaults) {
    const auto options = options_of<ScoreOptions>({"score", "a.clf", "a.relations"});
    EXPECT_EQ(options.log, "a.clf");
    EXPECT_EQ(options.relations, "a.relations");
    EXPECT_EQ(options.poses, Poses::kOdometry);
    EXPECT_FALSE(options.trajectory);
    EXPECT_EQ(options.perturbation.odometry_scale, 1.0);
    EXPECT_FALSE(options.perturbation.drops_scans());
    const auto other = options_of<ScoreOptions>(
        {"score", "a.clf", "a.relations", "--poses", "none", "--trajectory", "t.tum", "--every", "2", "--skip", "100"});
    EXPECT_EQ(other.poses, Poses::kNone);
    EXPECT_EQ(other.trajectory, "t.tum");
    EXPECT_EQ(other.perturbation.every, 2U);
    EXPECT_EQ(other.perturbation.skip, 100U);
    const auto scaled = options_of<ScoreOptions>({"score", "a.clf", "a.relations", "--odometry-scale", "1.03"});
    EXPECT_EQ(scaled.perturbation.odometry_scale, 1.03);
}

TEST(LabOptionsTest, LocalizationHasADirectoryAndPairsOfFiles) {
    const auto options =
        options_of<LocalizationOptions>({"localization", "--out", "d", "a.clf", "a.relations", "b.clf.gz", "b.txt"});
    EXPECT_EQ(options.out, "d");
    ASSERT_EQ(options.files.size(), 2U);
    EXPECT_EQ(options.files[0].log, "a.clf");
    EXPECT_EQ(options.files[0].relations, "a.relations");
    EXPECT_EQ(options.files[1].log, "b.clf.gz");
    EXPECT_EQ(options.files[1].relations, "b.txt");
    EXPECT_EQ(options_of<LocalizationOptions>({"localization", "a.clf", "a.relations", "--out", "d"}).files.size(), 1U);
}

TEST(LabOptionsTest, InvalidOptionIsAOneLineUsageError) {
    const std::vector<std::pair<std::vector<const char*>, const char*>> mistakes{
        {{}, "name a command: experiment, landmarks, score or localization"},
        {{"experiment"}, "experiment: name a directory with --out"},
        {{"experiment", "--out", "d", "--scans", "9"}, "--scans"},
        {{"experiment", "--out", "d", "--scans", "10.5"}, "--scans"},
        {{"experiment", "--out", "d", "--seed", "-1"}, "--seed"},
        {{"experiment", "--out", "d", "--bogus"}, "--bogus"},
        {{"landmark"}, "name a command: experiment, landmarks, score or localization"},
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
        {{"localization", "a", "b"}, "localization: name a directory with --out"},
        {{"localization", "--out", "d"}, "localization: name pairs of files, LOG RELATIONS"},
        {{"localization", "--out", "d", "a"}, "localization: name pairs of files, LOG RELATIONS"},
        {{"localization", "--out", "d", "a", "b", "c"}, "localization: name pairs of files, LOG RELATIONS"},
        {{"localization", "--out", "d", "x/a.clf", "b", "y/a.log.gz", "b"},
         "x/a.clf and y/a.log.gz would have the same pictures"},
        {{"localization", "--out", "d", "a", "b", "--seed", "1"}, "--seed"},
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
    EXPECT_THAT(std::get<Leave>(parse({"localization", "--help"})).text, HasSubstr("LOG RELATIONS"));
    EXPECT_EQ(std::get<Leave>(parse({"landmarks", "--help"})).code, kExitDone);
    EXPECT_THAT(std::get<Leave>(parse({"landmarks", "--help"})).text, HasSubstr("--capture"));
    EXPECT_THAT(std::get<Leave>(parse({"--version"})).text, HasSubstr("scanloom-lab "));
}

} // namespace
} // namespace scanloom::lab

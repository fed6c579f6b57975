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

TEST(LabOptionsTest, ClusterHasDefaultsAndCompletesThePlan) {
    const auto plan = options_of<cluster::Plan>({"cluster"});
    EXPECT_EQ(plan.robots, 10'000U);
    EXPECT_EQ(plan.upgrade_at_hours, 12.0);
    const auto other = options_of<cluster::Plan>(
        {"cluster", "--robots", "500", "--close-ms", "2.5", "--duration", "3", "--node-us", "19", "--seed", "7"});
    EXPECT_EQ(other.robots, 500U);
    EXPECT_EQ(other.close_ms, 2.5);
    EXPECT_EQ(other.upgrade_at_hours, 1.5) << "half of the duration";
    EXPECT_EQ(other.node_us, 19.0);
    EXPECT_EQ(other.seed, 7U);
    EXPECT_EQ(options_of<cluster::Plan>({"cluster", "--upgrade-at", "2"}).upgrade_at_hours, 2.0);
    EXPECT_EQ(options_of<cluster::Plan>({"cluster", "--upgrade-at", "0"}).upgrade_at_hours, 0.0) << "no upgrade";
}

TEST(LabOptionsTest, InvalidOptionIsAOneLineUsageError) {
    const std::vector<std::pair<std::vector<const char*>, const char*>> mistakes{
        {{}, "name a command: experiment, landmarks, score, localization or cluster"},
        {{"experiment"}, "experiment: name a directory with --out"},
        {{"experiment", "--out", "d", "--scans", "9"}, "--scans"},
        {{"experiment", "--out", "d", "--scans", "10.5"}, "--scans"},
        {{"experiment", "--out", "d", "--seed", "-1"}, "--seed"},
        {{"experiment", "--out", "d", "--bogus"}, "--bogus"},
        {{"landmark"}, "name a command: experiment, landmarks, score, localization or cluster"},
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
        {{"cluster", "--robots", "0"}, "--robots"},
        {{"cluster", "--robots", "1.5"}, "--robots"},
        {{"cluster", "--rate", "0"}, "--rate"},
        {{"cluster", "--session-size", "1025"}, "--session-size"},
        {{"cluster", "--nodes", "5000"}, "--nodes"},
        {{"cluster", "--silent", "1.1"}, "--silent"},
        {{"cluster", "--close-ms", "-1"}, "--close-ms"},
        {{"cluster", "--robots", "5"}, "cluster: --session-size 10 is more than --robots 5"},
        {{"cluster", "--upgrade-at", "30"}, "cluster: --upgrade-at 30 is not within the 24 hours of --duration"},
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

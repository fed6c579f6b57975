#include "tests/unit/robot_client/app/options_fixture.hpp"

#include <gmock/gmock.h>

#include <limits>

/// Options of the command line, the environment and the file.
namespace scanloom::robot {
namespace {

using testing::HasSubstr;

TEST_F(Options, SectionOfTheSourceMayHoldAnOptionOfTheProgram) {
    const std::vector<std::string> words{"--config", file("session = \"s\"\nrobot = \"r\"\nposes = \"odometry\"\n"
                                                          "[ld06]\npose-file = \"p\"\nreopen-for = 5\n"
                                                          "[replay]\nposes = \"none\"\nspeed = 2\n")};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), words.begin(), words.end());
        return more;
    };
    const auto replay = parsed(with({"replay", "f"}));
    EXPECT_EQ(replay.poses, Poses::kNone) << "the section comes before the rest of the file";
    EXPECT_EQ(std::get<ReplayOptions>(replay.source).speed, 2.0);
    EXPECT_EQ(parsed(with({"replay", "f", "--poses", "map"})).poses, Poses::kMap);
    EXPECT_EQ(parsed(with({"ld06", "f"})).poses, Poses::kOdometry) << "the section is of another source";
    set("SCANLOOM_POSES", "map");
    EXPECT_EQ(parsed(with({"replay", "f"})).poses, Poses::kMap);
    const auto old = file("session = \"s\"\nrobot = \"r\"\n[ld06]\nposes = \"p.txt\"\n");
    unsetenv("SCANLOOM_POSES");
    EXPECT_EQ(std::get<LidarOptions>(parsed({"ld06", "f", "--config", old}).source).pose_file, "p.txt");
    EXPECT_EQ(parsed({"simulate", "--config", old}).poses, std::nullopt);
}

TEST_F(Options, FlagOverridesEnvironmentOverridesFile) {
    const auto path =
        file("session = \"from_file\"\nrobot = \"r\"\ncell-size = 0.1\n[simulate]\nseed = 5\nworld = \"room\"\n");
    const std::vector<std::string> words{"simulate", "--config", path};
    EXPECT_EQ(parsed(words).session, "from_file");
    EXPECT_EQ(parsed(words).cell_size, 0.1);
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(parsed(words).source).seed, 5U);
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(parsed(words).source).world, "room");
    set("SCANLOOM_SESSION", "from_environment");
    set("SCANLOOM_CELL_SIZE", "0.2");
    set("SCANLOOM_SEED", "6");
    EXPECT_EQ(parsed(words).session, "from_environment");
    EXPECT_EQ(parsed(words).cell_size, 0.2);
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(parsed(words).source).seed, 6U);
    const std::vector<std::string> flags{"simulate",    "--config", path,     "--session", "from_flag",
                                         "--cell-size", "0.3",      "--seed", "7"};
    EXPECT_EQ(parsed(flags).session, "from_flag");
    EXPECT_EQ(parsed(flags).cell_size, 0.3);
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(parsed(flags).source).seed, 7U);
}

TEST_F(Options, EnvironmentNamesTheFileForBothSources) {
    set("SCANLOOM_CONFIG", file("session = \"s\"\nrobot = \"r\"\n").c_str());
    set("SCANLOOM_SPEED", "3");
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(parsed({"simulate"}).source).speed, 3.0);
    EXPECT_EQ(std::get<ReplayOptions>(parsed({"replay", "f"}).source).speed, 3.0);
}

TEST_F(Options, MissingFileOfTheEnvironmentIsAnError) {
    set("SCANLOOM_CONFIG", "/nonexistent.toml");
    EXPECT_EQ(left({"simulate", "--session", "s", "--robot", "r"}).code, kExitUsage);
}

TEST_F(Options, SeedsUseTheirFullRangeAlsoInTheFile) {
    const std::vector<std::string> words{
        "simulate", "--session", "s", "--robot", "r", "--config", file("[simulate]\nseed = -1\n")};
    EXPECT_THAT(left(words).text, HasSubstr("--seed"));
    const auto largest = parsed({"simulate", "--session", "s", "--robot", "r", "--seed", "18446744073709551615"});
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(largest.source).seed, std::numeric_limits<std::uint64_t>::max());
}

} // namespace
} // namespace scanloom::robot

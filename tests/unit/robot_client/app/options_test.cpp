#include "tests/unit/robot_client/app/options_fixture.hpp"

#include "sim/ground_truth.hpp"

#include <gmock/gmock.h>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

TEST_F(Options, AreAcceptedBeforeAndAfterTheSubcommand) {
    for (const auto& words :
         {std::vector<std::string>{"--server", "h:1", "--session", "s", "--robot", "r", "replay", "f.clf", "--speed",
                                   "2"},
          std::vector<std::string>{"replay", "f.clf", "--speed", "2", "--server", "h:1", "--session", "s", "--robot",
                                   "r"},
          std::vector<std::string>{"--session", "s", "replay", "--speed=2", "--robot=r", "f.clf", "--server=h:1"}}) {
        const auto options = parsed(words);
        EXPECT_EQ(options.servers.at(0).text(), "h:1");
        EXPECT_EQ(options.session, "s");
        EXPECT_EQ(std::get<ReplayOptions>(options.source).file, "f.clf");
        EXPECT_EQ(std::get<ReplayOptions>(options.source).speed, 2.0);
    }
}

TEST_F(Options, DefaultsAreAsDocumented) {
    const auto replay = parsed({"replay", "f", "--session", "s", "--robot", "r"});
    EXPECT_EQ(replay.servers.at(0).text(), "127.0.0.1:7447");
    EXPECT_EQ(std::get<ReplayOptions>(replay.source).speed, 0.0);
    EXPECT_FALSE(replay.give_up_after) << "it depends on the source";
    EXPECT_TRUE(replay.spool.empty());
    EXPECT_EQ(replay.when_full, WhenFull::kDropOldest);
    EXPECT_FALSE(replay.compress);
    EXPECT_FALSE(replay.cell_size || replay.range_max || replay.no_return);
    const auto simulate = parsed({"simulate", "--session", "s", "--robot", "r"});
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(simulate.source).speed, 1.0);
    EXPECT_FALSE(std::get<sim::SimulatedRobotOptions>(simulate.source).duration);
}

TEST_F(Options, QueueAndTransportAreConfigurable) {
    const auto given = parsed({"ld06",         "/dev/x", "--pose",        "0,0,0",        "--session",       "s",
                               "--robot",      "r",      "--spool",       "/var/spool/x", "--spool-size",    "2",
                               "--memory",     "0.5",    "--when-full",   "drop-newest",  "--batch-delay",   "1.5",
                               "--batch-size", "8",      "--compression", "zstd",         "--give-up-after", "0"});
    EXPECT_EQ(given.spool, "/var/spool/x");
    EXPECT_EQ(given.spool_bytes_max, 2U << 20);
    EXPECT_EQ(given.memory_bytes_max, 1U << 19);
    EXPECT_EQ(given.when_full, WhenFull::kDropNewest);
    EXPECT_EQ(given.batch_delay, std::chrono::milliseconds(1500));
    EXPECT_EQ(given.batch_bytes_max, 8U << 10);
    EXPECT_TRUE(given.compress);
    EXPECT_EQ(given.give_up_after, std::chrono::milliseconds(0));
    for (const auto& wrong : {std::pair{"--spool-size", "0"},
                              {"--memory", "nan"},
                              {"--when-full", "wait"},
                              {"--batch-delay", "-1"},
                              {"--compression", "gzip"}}) {
        EXPECT_EQ(left({"simulate", "--session", "s", "--robot", "r", wrong.first, wrong.second}).code, kExitUsage);
    }
}

TEST_F(Options, BodyRadiusIsAcceptedForEverySource) {
    EXPECT_EQ(parsed({"simulate", "--session", "s", "--robot", "r"}).body_radius, std::nullopt);
    EXPECT_EQ(parsed({"replay", "f", "--session", "s", "--robot", "r", "--body-radius", "5"}).body_radius, 5.0);
    for (const auto* radius : {"0", "-1", "5.1", "nan", "x"}) {
        const auto refused = left({"simulate", "--session", "s", "--robot", "r", "--body-radius", radius});
        EXPECT_EQ(refused.code, kExitUsage) << radius;
    }
}

TEST_F(Options, TruthNeedsNoServerSessionOrRobot) {
    const auto result = parse({"truth", "--world", "a map.yaml", "--output", "x", "--cell-size", "0.2"});
    ASSERT_TRUE(std::holds_alternative<GroundTruthOptions>(result));
    const auto& truth = std::get<GroundTruthOptions>(result);
    EXPECT_EQ(truth.world + " " + truth.output, "a map.yaml x");
    EXPECT_EQ(truth.cell_size, 0.2);
}

TEST_F(Options, SimulatedRobotHasSensorsNoiseAndSentPose) {
    const auto plain =
        std::get<sim::SimulatedRobotOptions>(parsed({"simulate", "--session", "s", "--robot", "r"}).source);
    EXPECT_EQ(plain.laser + " " + plain.sonar + " " + plain.pose, "reference none true");
    EXPECT_FALSE(plain.odometry_noise);
    const auto other = std::get<sim::SimulatedRobotOptions>(
        parsed({"simulate", "--session", "s", "--robot", "r", "--laser", "none", "--sonar", "ring16", "--pose",
                "odometry", "--odometry-noise", "2.5", "--world", "m.yaml"})
            .source);
    EXPECT_EQ(other.laser + " " + other.sonar + " " + other.pose + " " + other.world, "none ring16 odometry m.yaml");
    EXPECT_EQ(other.odometry_noise, 2.5);
    set("SCANLOOM_POSE", "0,0,0"); // of another source
    EXPECT_EQ(std::get<ReplayOptions>(parsed({"replay", "f", "--session", "s", "--robot", "r"}).source).file, "f");
}

TEST_F(Options, SonarTakesTwoFilesAndAnAperture) {
    const auto options = parsed({"sonar", "m.txt", "p.txt", "--aperture", "15", "--session", "s", "--robot", "r"});
    const auto& sonar = std::get<SonarReplayOptions>(options.source);
    EXPECT_EQ(sonar.measurements + " " + sonar.poses, "m.txt p.txt");
    EXPECT_EQ(sonar.aperture_deg, 15.0);
    EXPECT_EQ(sonar.speed, 0.0);
}

TEST_F(Options, PosesAreAcceptedAtEveryPlace) {
    const auto poses_of = [&](std::vector<std::string> words) {
        words.insert(words.begin(), {"--session", "s", "--robot", "r"});
        return parsed(words).poses;
    };
    EXPECT_EQ(poses_of({"replay", "f"}), std::nullopt) << "the source decides";
    EXPECT_EQ(poses_of({"--poses", "odometry", "replay", "f"}), Poses::kOdometry);
    EXPECT_EQ(poses_of({"replay", "f", "--poses", "none"}), Poses::kNone);
    EXPECT_EQ(poses_of({"sonar", "m", "p", "--poses", "odometry"}), Poses::kOdometry);
    EXPECT_EQ(poses_of({"simulate", "--poses=none"}), Poses::kNone);
    const auto top = file("poses = \"none\"\n");
    EXPECT_EQ(poses_of({"replay", "f", "--config", top}), Poses::kNone);
    set("SCANLOOM_POSES", "odometry");
    EXPECT_EQ(poses_of({"replay", "f"}), Poses::kOdometry);
    EXPECT_EQ(poses_of({"replay", "f", "--config", top}), Poses::kOdometry);
    EXPECT_EQ(poses_of({"replay", "f", "--poses", "map"}), Poses::kMap);
}

TEST_F(Options, RecordingsHaveTopicsFramesAndMounts) {
    const auto options = parsed({"--session",
                                 "s",
                                 "--robot",
                                 "r",
                                 "replay",
                                 "f.bag",
                                 "--topic",
                                 "/front",
                                 "--topic",
                                 "/rear",
                                 "--odom-topic",
                                 "/wheels",
                                 "--base-frame",
                                 "base",
                                 "--fixed-frame",
                                 "odom",
                                 "--mount",
                                 "/front=0.2,-0.1,1.5",
                                 "--mount=-0.064,0,0",
                                 "--zero",
                                 "no-return",
                                 "--beyond-max",
                                 "broken"});
    const auto& recording = std::get<ReplayOptions>(options.source).recording;
    EXPECT_EQ(recording.topics, (std::vector<std::string>{"/front", "/rear"}));
    EXPECT_EQ(recording.odom_topic, "/wheels");
    EXPECT_EQ(recording.base_frame, "base");
    EXPECT_EQ(recording.fixed_frame, "odom");
    ASSERT_EQ(recording.mounts.size(), 2U);
    EXPECT_EQ(recording.mounts[0].topic, "/front");
    EXPECT_EQ(recording.mounts[0].T_robot_laser, (Pose2{0.2, -0.1, 1.5}));
    EXPECT_EQ(recording.mounts[1].topic, "");
    EXPECT_EQ(recording.mounts[1].T_robot_laser.x, -0.064);
    EXPECT_EQ(recording.ranges.is_zero_no_return, true);
    EXPECT_EQ(recording.ranges.is_beyond_no_return, false);
}

TEST_F(Options, ServerIsHostAndPort) {
    const auto servers = [&](const std::string& server) {
        return parsed({"replay", "f", "--session", "s", "--robot", "r", "--server", server}).servers;
    };
    EXPECT_EQ(servers("maps.example:7447").at(0).host, "maps.example");
    EXPECT_EQ(servers("[::1]:7447").at(0).host, "::1");
    EXPECT_EQ(servers("a:1,[::1]:2,c:3").at(1).text(), "[::1]:2");
    EXPECT_EQ(servers("a:1,[::1]:2,c:3").size(), 3U);
    for (const char* bad : {"host", "host:", ":1", "host:0", "host:65536", "host:x", "::1:7447", "host:-1",
                            "host:99999999999", "host:1,", "host:1,,b:2"}) {
        const auto leave = left({"replay", "f", "--session", "s", "--robot", "r", "--server", bad});
        EXPECT_EQ(leave.code, kExitUsage) << bad;
        EXPECT_THAT(leave.text, HasSubstr("HOST:PORT"));
    }
}

TEST_F(Options, MistakesAreOneLineUsageErrors) {
    const std::vector<std::string> good{"simulate", "--session", "s", "--robot", "r"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), good.begin(), good.end());
        return more;
    };
    const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes{
        {{}, "name a source"},
        {{"--session", "s", "--robot", "r"},
         "name a source: replay FILE, sonar MEASUREMENTS POSES, lidar MODEL DEVICE, ld06 INPUT, foxglove URL, or "
         "simulate; or a command: info FILE, lidars, or truth;"},
        {{"simulate", "--robot", "r"}, "--session is required"},
        {{"simulate", "--session", "a/b", "--robot", "r"}, "'a/b' is not a name"},
        {{"replay", "--session", "s", "--robot", "r"}, "name the FILE"},
        {{"sonar", "m.txt", "--session", "s", "--robot", "r"}, "name two files"},
        {{"sonar", "m", "p", "--aperture", "181", "--session", "s", "--robot", "r"}, "--aperture"},
        {{"simulate", "--session", "s"}, "--robot is required"},
        {with({"--world", "moon"}), "moon"},
        {with({"--laser", "none"}), "needs --sonar ring16"},
        {with({"--laser", "handheld", "--sonar", "ring16"}), "leave --sonar out"},
        {with({"--drive", "home"}), "home"},
        {with({"--drive", "explore", "--laser", "none", "--sonar", "ring16"}), "--drive explore needs a --laser"},
        {with({"--drive", "zigzag", "--pose", "odometry"}), "use --pose true"},
        {with({"--drive", "zigzag", "--waypoints", "1,2"}), "use --drive waypoints"},
        {with({"--sonar", "bat"}), "bat"},
        {with({"--odometry-noise", "-1"}), "--odometry-noise"},
        {with({"--pose", "wrong"}), "wrong"},
        {with({"--poses", "wrong"}), "--poses: 'wrong' is not map, odometry or none"},
        {with({"--poses", ""}), "given but empty"},
        {{"replay", "f", "--session", "s", "--robot", "r", "--poses", "p"}, "'p' is not map, odometry or none"},
        {{"sonar", "m", "p", "--session", "s", "--robot", "r", "--poses", "none"},
         "cannot locate a robot that has only"},
        {with({"--poses", "none", "--pose", "odometry"}), "--pose odometry has no effect with --poses none"},
        {with({"--poses", "none", "--laser", "none", "--sonar", "ring16"}), "give it a --laser"},
        {with({"--poses", "odometry", "--drive", "zigzag"}), "use --poses map"},
        {with({"--poses", "none", "--drive", "explore"}), "in which --poses none sends no pose"},
        {{"truth", "--output", "x"}, "name the --world"},
        {{"truth", "--world", "room"}, "--output PREFIX"},
        {{"truth", "--world", "room", "--output", "folder/"}, "--output PREFIX"},
        {{"truth", "--world", "moon", "--output", "x"}, "moon"},
        {{"truth", "--world", "room", "--output", "x", "--cell-size", "0"}, "--cell-size"},
        {with({"--noise", "loud"}), "loud"},
        {with({"--noise-width", "0"}), "--noise-width"},
        {with({"--noise-width", "0.1"}), "--noise-width does not apply to --noise none; use --noise uniform"},
        {with({"--noise-width", "0.1", "--noise", "gaussian"}), "use --noise uniform"},
        {with({"--spool", "d"}), "leave --spool out"},
        {{"replay", "f", "--session", "s", "--robot", "r", "--spool", "d"}, "leave --spool out"},
        {{"sonar", "m", "p", "--session", "s", "--robot", "r", "--spool", "d"}, "leave --spool out"},
        {with({"--no-return", "maybe"}), "maybe"},
        {with({"--cell-size", "0"}), "--cell-size"},
        {with({"--cell-size", "nan"}), "--cell-size"},
        {with({"--cell-size", "2"}), "--cell-size"},
        {with({"--max-range", "0"}), "--max-range"},
        {with({"--max-range", "1001"}), "--max-range"},
        {with({"--max-range", "900", "--cell-size", "0.1"}), "--max-range 900 spans more than 8192 cells"},
        {with({"--speed", "-1"}), "--speed"},
        {with({"--speed", "inf"}), "--speed"},
        {with({"--scans", "0"}), "--scans"},
        {with({"--scans", "1.5"}), "--scans"},
        {with({"--scans", "18446744073709551616"}), "--scans"},
        {with({"--duration", "nan"}), "--duration"},
        {with({"--duration", "-1"}), "--duration"},
        {with({"--seed", "x"}), "--seed"},
        {with({"--seed", "-1"}), "--seed: '-1' is not a whole number"},
        {with({"--seed", "18446744073709551616"}), "--seed"},
        {with({"--token-file", "/nonexistent"}), "/nonexistent"},
        {with({"--bogus"}), "--bogus"},
        {with({"--config", "/nonexistent.toml"}), "/nonexistent.toml"},
        {with({"--config", file("bogus = 1\n")}), "bogus"},
    };
    for (const auto& [words, hint] : mistakes) {
        const auto leave = left(words);
        EXPECT_EQ(leave.code, kExitUsage);
        EXPECT_THAT(leave.text, HasSubstr(hint));
        EXPECT_EQ(std::count(leave.text.begin(), leave.text.end(), '\n'), 1) << leave.text;
    }
}

TEST_F(Options, ExplorerMayHaveASpool) {
    EXPECT_EQ(parsed({"simulate", "--drive", "explore", "--session", "s", "--robot", "r", "--spool", "d"}).spool, "d");
}

TEST_F(Options, UniformNoiseWidthIsConfigurable) {
    const auto options =
        parsed({"simulate", "--session", "s", "--robot", "r", "--noise", "uniform", "--noise-width", "0.1"});
    EXPECT_EQ(std::get<sim::SimulatedRobotOptions>(options.source).noise_width, 0.1);
}

TEST_F(Options, HelpNamesTheFolderOfWorlds) {
    const auto help = left({"simulate", "--help"}).text;
    for (const sim::NamedWorld& world : sim::kWorlds) {
        const sim::GroundTruthGrid truth = ground_truth_of(world.make(), 0.5);
        std::int32_t right = 0;
        std::int32_t top = 0;
        for (std::int32_t j = truth.j_begin; j < truth.j_begin + truth.height; ++j) {
            for (std::int32_t i = truth.i_begin; i < truth.i_begin + truth.width; ++i) {
                if (truth.at(i, j) != sim::GroundTruth::kFree) continue;
                right = std::max({right, i + 1, -i});
                top = std::max({top, j + 1, -j});
            }
        }
        EXPECT_THAT(help, HasSubstr(fmt::format("x -{0:g} to {0:g}, y -{1:g} to {1:g}", right / 2.0, top / 2.0)));
    }
}

TEST_F(Options, HelpNamesTheEndOfLogs) { EXPECT_THAT(left({"--help"}).text, HasSubstr("for logs at most 50")); }

TEST_F(Options, HelpAndVersionAreNotErrors) {
    EXPECT_EQ(left({"--help"}).code, kExitDone);
    EXPECT_THAT(left({"--help"}).text, HasSubstr("replay"));
    EXPECT_THAT(left({"simulate", "--help"}).text, HasSubstr("--laser"));
    EXPECT_EQ(left({"--version"}).text, fmt::format("scanloom-robot {}\n", kVersion));
}

TEST_F(Options, InfoTakesAndRepeatsThoseOfARecording) {
    const auto result = parse({"info", "a.bag", "--topic", "/r1/scan", "--mount", "1,2,0.5", "--poses", "odometry"});
    const auto& info = std::get<InfoOptions>(result);
    EXPECT_EQ(info.recording.topics, std::vector<std::string>{"/r1/scan"});
    EXPECT_EQ(info.recording.poses, Poses::kOdometry);
    EXPECT_EQ(info.recording.mounts.size(), 1U);
    EXPECT_EQ(info.scan_arguments, " --poses 'odometry'");
    EXPECT_EQ(info.ros_arguments, " --topic '/r1/scan' --mount '1,2,0.5'");
}

} // namespace
} // namespace scanloom::robot

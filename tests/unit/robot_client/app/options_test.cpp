#include "robot_client/app/options.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

class Options : public testing::Test {
protected:
    std::variant<RobotOptions, Leave> parse(std::vector<std::string> words) {
        std::vector<const char*> argv{"scanloom-robot"};
        for (const auto& word : words) argv.push_back(word.c_str());
        return parse_options(static_cast<int>(argv.size()), argv.data());
    }

    RobotOptions parsed(const std::vector<std::string>& words) {
        auto result = parse(words);
        if (const auto* leave = std::get_if<Leave>(&result)) {
            ADD_FAILURE() << leave->text;
            return {};
        }
        return std::get<RobotOptions>(result);
    }

    Leave left(const std::vector<std::string>& words) {
        auto result = parse(words);
        if (const auto* leave = std::get_if<Leave>(&result)) return *leave;
        ADD_FAILURE() << "no reason to leave";
        return {};
    }

    void set(const char* name, const char* value) {
        setenv(name, value, 1);
        set_.emplace_back(name);
    }

    std::string file(std::string_view text) {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        file_ = std::filesystem::path(testing::TempDir()) / fmt::format("scanloom_options_{}.toml", test->name());
        std::ofstream(file_) << text;
        return file_.string();
    }

    void TearDown() override {
        for (const auto& name : set_) unsetenv(name.c_str());
        if (!file_.empty()) std::filesystem::remove(file_);
    }

private:
    std::vector<std::string> set_;
    std::filesystem::path file_;
};

TEST_F(Options, MayStandBeforeOrBehindTheSubcommand) {
    for (const auto& words :
         {std::vector<std::string>{"--server", "h:1", "--session", "s", "--robot", "r", "replay", "f.clf", "--speed",
                                   "2"},
          std::vector<std::string>{"replay", "f.clf", "--speed", "2", "--server", "h:1", "--session", "s", "--robot",
                                   "r"},
          std::vector<std::string>{"--session", "s", "replay", "--speed=2", "--robot=r", "f.clf", "--server=h:1"}}) {
        const auto options = parsed(words);
        EXPECT_EQ(options.host, "h");
        EXPECT_EQ(options.port, "1");
        EXPECT_EQ(options.session, "s");
        EXPECT_EQ(std::get<ReplayOptions>(options.source).file, "f.clf");
        EXPECT_EQ(std::get<ReplayOptions>(options.source).speed, 2.0);
    }
}

TEST_F(Options, DefaultsAreThoseOfTheContract) {
    const auto replay = parsed({"replay", "f", "--session", "s", "--robot", "r"});
    EXPECT_EQ(replay.host + ":" + replay.port, "127.0.0.1:7447");
    EXPECT_EQ(std::get<ReplayOptions>(replay.source).speed, 0.0);
    EXPECT_EQ(replay.give_up_after, std::chrono::seconds(120));
    EXPECT_FALSE(replay.cell_size || replay.range_max || replay.no_return);
    const auto simulate = parsed({"simulate", "--session", "s", "--robot", "r"});
    EXPECT_EQ(std::get<SimulateOptions>(simulate.source).speed, 1.0);
    EXPECT_FALSE(std::get<SimulateOptions>(simulate.source).duration);
}

TEST_F(Options, ABodyIsStatedForAnySource) {
    EXPECT_EQ(parsed({"simulate", "--session", "s", "--robot", "r"}).body_radius, std::nullopt);
    EXPECT_EQ(parsed({"replay", "f", "--session", "s", "--robot", "r", "--body-radius", "5"}).body_radius, 5.0);
    for (const auto* radius : {"0", "-1", "5.1", "nan", "x"}) {
        const auto refused = left({"simulate", "--session", "s", "--robot", "r", "--body-radius", radius});
        EXPECT_EQ(refused.code, kExitUsage) << radius;
    }
}

TEST_F(Options, SonarTakesTwoFilesAndItsAperture) {
    const auto options = parsed({"sonar", "m.txt", "p.txt", "--aperture", "15", "--session", "s", "--robot", "r"});
    const auto& sonar = std::get<SonarReplayOptions>(options.source);
    EXPECT_EQ(sonar.measurements + " " + sonar.poses, "m.txt p.txt");
    EXPECT_EQ(sonar.aperture_deg, 15.0);
    EXPECT_EQ(sonar.speed, 0.0);
}

TEST_F(Options, FlagBeatsEnvironmentBeatsFile) {
    const auto path =
        file("session = \"from_file\"\nrobot = \"r\"\ncell-size = 0.1\n[simulate]\nseed = 5\nworld = \"room\"\n");
    const std::vector<std::string> words{"simulate", "--config", path};
    EXPECT_EQ(parsed(words).session, "from_file");
    EXPECT_EQ(parsed(words).cell_size, 0.1);
    EXPECT_EQ(std::get<SimulateOptions>(parsed(words).source).seed, 5U);
    EXPECT_EQ(std::get<SimulateOptions>(parsed(words).source).world, "room");
    set("SCANLOOM_SESSION", "from_environment");
    set("SCANLOOM_CELL_SIZE", "0.2");
    set("SCANLOOM_SEED", "6");
    EXPECT_EQ(parsed(words).session, "from_environment");
    EXPECT_EQ(parsed(words).cell_size, 0.2);
    EXPECT_EQ(std::get<SimulateOptions>(parsed(words).source).seed, 6U);
    const std::vector<std::string> flags{"simulate",    "--config", path,     "--session", "from_flag",
                                         "--cell-size", "0.3",      "--seed", "7"};
    EXPECT_EQ(parsed(flags).session, "from_flag");
    EXPECT_EQ(parsed(flags).cell_size, 0.3);
    EXPECT_EQ(std::get<SimulateOptions>(parsed(flags).source).seed, 7U);
}

TEST_F(Options, TheEnvironmentMayNameTheFileAndServesBothSources) {
    set("SCANLOOM_CONFIG", file("session = \"s\"\nrobot = \"r\"\n").c_str());
    set("SCANLOOM_SPEED", "3");
    EXPECT_EQ(std::get<SimulateOptions>(parsed({"simulate"}).source).speed, 3.0);
    EXPECT_EQ(std::get<ReplayOptions>(parsed({"replay", "f"}).source).speed, 3.0);
}

TEST_F(Options, AFileThatTheEnvironmentNamesMustBeThere) {
    set("SCANLOOM_CONFIG", "/nonexistent.toml");
    EXPECT_EQ(left({"simulate", "--session", "s", "--robot", "r"}).code, kExitUsage);
}

TEST_F(Options, ServersAreHostAndPort) {
    const auto host = [&](const std::string& server) {
        return parsed({"replay", "f", "--session", "s", "--robot", "r", "--server", server}).host;
    };
    EXPECT_EQ(host("maps.example:7447"), "maps.example");
    EXPECT_EQ(host("[::1]:7447"), "::1");
    for (const char* bad :
         {"host", "host:", ":1", "host:0", "host:65536", "host:x", "::1:7447", "host:-1", "host:99999999999"}) {
        const auto leave = left({"replay", "f", "--session", "s", "--robot", "r", "--server", bad});
        EXPECT_EQ(leave.code, kExitUsage) << bad;
        EXPECT_THAT(leave.text, HasSubstr("HOST:PORT"));
    }
}

TEST_F(Options, EachMistakeIsOneLineAndAUsageError) {
    const std::vector<std::string> good{"simulate", "--session", "s", "--robot", "r"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), good.begin(), good.end());
        return more;
    };
    const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes{
        {{}, "--session"},
        {{"--session", "s", "--robot", "r"},
         "say what to stream: replay FILE, sonar MEASUREMENTS POSES, ld06 INPUT, or simulate;"},
        {{"simulate", "--robot", "r"}, "--session is required"},
        {{"simulate", "--session", "a/b", "--robot", "r"}, "'a/b' is not a name"},
        {{"replay", "--session", "s", "--robot", "r"}, "name the FILE"},
        {{"sonar", "m.txt", "--session", "s", "--robot", "r"}, "name two files"},
        {{"sonar", "m", "p", "--aperture", "181", "--session", "s", "--robot", "r"}, "--aperture"},
        {with({"--world", "moon"}), "moon"},
        {with({"--noise", "loud"}), "loud"},
        {with({"--noise-width", "0"}), "--noise-width"},
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

TEST_F(Options, SeedsReachAsFarAsTheirTypeAlsoInTheFile) {
    const std::vector<std::string> words{
        "simulate", "--session", "s", "--robot", "r", "--config", file("[simulate]\nseed = -1\n")};
    EXPECT_THAT(left(words).text, HasSubstr("--seed"));
    const auto largest = parsed({"simulate", "--session", "s", "--robot", "r", "--seed", "18446744073709551615"});
    EXPECT_EQ(std::get<SimulateOptions>(largest.source).seed, std::numeric_limits<std::uint64_t>::max());
}

TEST_F(Options, HelpTellsWhereLogsEnd) { EXPECT_THAT(left({"--help"}).text, HasSubstr("for logs 50")); }

TEST_F(Options, HelpAndVersionAreNotErrors) {
    EXPECT_EQ(left({"--help"}).code, kExitDone);
    EXPECT_THAT(left({"--help"}).text, HasSubstr("replay"));
    EXPECT_THAT(left({"simulate", "--help"}).text, HasSubstr("--laser"));
    EXPECT_EQ(left({"--version"}).text, fmt::format("scanloom-robot {}\n", kVersion));
}

} // namespace
} // namespace scanloom::robot

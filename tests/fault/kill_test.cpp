#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/parse.hpp>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <random>

namespace scanloom::test {
namespace {

/// The source of the robot's scans: a real log if there is one, otherwise the simulator.
struct Stream {
    std::vector<std::string> source;
    std::uint64_t scans;
};

const std::filesystem::path kIntel = std::filesystem::path(SCANLOOM_SOURCE_DIR) / "../shared/data/logs/intel.clf.bz2";

Stream real_log() { return {{"replay", kIntel.string()}, 13'631}; }

Stream simulated() {
    return {
        {"simulate", "--world", "office", "--drive", "wall_follower", "--seed", "7", "--speed", "0", "--scans", "3000"},
        3000};
}

std::vector<std::string> robot_arguments(const RunningServer& server, const Stream& stream) {
    std::vector<std::string> arguments{"--server", server.robot_address(), "--session", "s", "--robot",
                                       "r",        "--cell-size",          "0.1"};
    arguments.insert(arguments.end(), stream.source.begin(), stream.source.end());
    return arguments;
}

/// Returns the robot's summary line after a successful end.
boost::json::value finish(ChildProcess& robot) {
    const auto line = robot.read_line();
    EXPECT_EQ(robot.wait(), 0);
    return line ? boost::json::parse(*line) : boost::json::value();
}

void expect_all_acknowledged(const boost::json::value& summary, std::uint64_t scans) {
    ASSERT_TRUE(summary.is_object());
    EXPECT_EQ(summary.at("scans").to_number<std::uint64_t>(), scans);
    EXPECT_EQ(summary.at("acknowledged").to_number<std::uint64_t>(), scans);
}

std::string undisturbed_digest(const Stream& stream) {
    TemporaryDirectory place;
    RunningServer server(place.path() / "store", place.path() / "log");
    ChildProcess robot(program("scanloom-robot"), robot_arguments(server, stream), place.path() / "robot");
    expect_all_acknowledged(finish(robot), stream.scans);
    return server.get("/api/v1/sessions/s/digest").body;
}

/// Polls until the map of the session holds more than `scans` scans. @return false if the server answers with an
/// unexpected status
bool wait_for_scans(const RunningServer& server, std::uint64_t scans) {
    for (;;) {
        const auto answer = server.get("/api/v1/sessions/s");
        if (answer.status != 200 && answer.status != 404) return false;
        if (answer.status == 200 && boost::json::parse(answer.body).at("scans").to_number<std::uint64_t>() > scans)
            return true;
    }
}

void kill_again_and_again(const Stream& stream, unsigned seed, int kills) {
    const std::string undisturbed = undisturbed_digest(stream);
    TemporaryDirectory place;
    auto server = std::make_unique<RunningServer>(place.path() / "store", place.path() / "log");
    ChildProcess robot(program("scanloom-robot"), robot_arguments(*server, stream), place.path() / "robot");
    std::mt19937 random(seed);
    for (int kill = 0; kill < kills; ++kill) {
        const std::uint64_t after =
            stream.scans * static_cast<std::uint64_t>(kill) / static_cast<std::uint64_t>(kills + 1) + random() % 50;
        ASSERT_TRUE(wait_for_scans(*server, after));
        server->process().signal(SIGKILL);
        EXPECT_EQ(server->process().wait(), -SIGKILL);
        const auto robot_port = server->robot_port();
        const auto http_port = server->http_port();
        server.reset();
        server = std::make_unique<RunningServer>(place.path() / "store", place.path() / "log", robot_port, http_port);
    }
    expect_all_acknowledged(finish(robot), stream.scans);
    EXPECT_EQ(server->get("/api/v1/sessions/s/digest").body, undisturbed);

    server->process().signal(SIGTERM);
    EXPECT_EQ(server->process().wait(), 0) << "the server stops cleanly on SIGTERM";
    const RunningServer again(place.path() / "store", place.path() / "log");
    EXPECT_EQ(again.get("/api/v1/sessions/s/digest").body, undisturbed) << "after a clean restart";
}

TEST(KillNineTrials, LosesAndDuplicatesNoAcknowledgedScan) { kill_again_and_again(simulated(), 1, 6); }

TEST(KillNineTrials, LosesNoScanOfARealLog) {
    if (!std::filesystem::exists(kIntel)) GTEST_SKIP() << "the Intel log is not at " << kIntel;
    kill_again_and_again(real_log(), 2, 5);
}

} // namespace
} // namespace scanloom::test

#include "tests/support/robot_socket.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/unread_pipe.hpp"

#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

/// Programs whose standard streams are closed or unusable.
namespace scanloom::test {
namespace {

using testing::HasSubstr;
using testing_support::RobotSocket;

TEST(StandardStreams, TheServerServesAndStopsWithoutAReaderOfItsLog) {
    const TemporaryDirectory place;
    UnreadPipe log(place.path() / "log");
    RunningServer server(place.path() / "store", log.path());
    for (int visit = 0; visit < 300; ++visit) {
        RobotSocket robot(server.robot_port());
        robot.send(wire::Hello{.robot = "r", .session = "s", .create = SessionOptions{}});
        (void)robot.receive_kind<wire::Welcome>();
    }
    EXPECT_EQ(server.get("/livez").status, 200U);
    EXPECT_THAT(log.empty(), HasSubstr("joined"));
    log.fill();
    server.process().signal(SIGTERM);
    EXPECT_EQ(server.process().wait(), 0);
}

TEST(StandardStreams, TheRobotSendsEverythingWithoutAReaderOfItsOutput) {
    const TemporaryDirectory place;
    const RunningServer server(place.path() / "store", place.path() / "log");
    UnreadPipe progress(place.path() / "progress");
    progress.fill();
    const auto recording = place.path() / "recording.log";
    std::ofstream(recording) << "FLASER is invalid here and reported on stderr\n"
                                "FLASER 3 1.0 1.0 1.0 0 0 0 0 0 0 1 host 1\n";
    ChildProcess robot(
        program("scanloom-robot"),
        {"--server", server.robot_address(), "--session", "s", "--robot", "r", "replay", recording.string()},
        progress.path());
    const auto summary = robot.read_line();
    EXPECT_EQ(robot.wait(), 0);
    ASSERT_TRUE(summary);
    EXPECT_EQ(boost::json::parse(*summary).at("acknowledged"), 1);
    EXPECT_EQ(boost::json::parse(*summary).at("skipped_lines"), 1);
}

/// Returns arguments of /bin/sh that run a program with some of its streams closed.
std::vector<std::string> with_closed(const std::string& streams, const std::string& name,
                                     const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"-c", "exec \"$0\" \"$@\" " + streams, program(name).string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return all;
}

std::filesystem::path stream_of(const ChildProcess& process, int number) {
    return std::filesystem::read_symlink(fmt::format("/proc/{}/fd/{}", process.id(), number));
}

TEST(StandardStreams, TheServerOpensNoFileAsAClosedStream) {
    const TemporaryDirectory place;
    ChildProcess server(
        "/bin/sh",
        with_closed("<&- 2>&-", "scanloom-server",
                    {"--store", place.path() / "store", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0"}),
        place.path() / "log");
    ASSERT_TRUE(server.read_line()) << "ready";
    EXPECT_EQ(stream_of(server, 0), "/dev/null");
    EXPECT_EQ(stream_of(server, 2), "/dev/null");
    server.signal(SIGTERM);
    EXPECT_EQ(server.wait(), 0);
}

TEST(StandardStreams, TheRobotOpensNoSocketAsAClosedStream) {
    const TemporaryDirectory place;
    const RunningServer server(place.path() / "store", place.path() / "log");
    ChildProcess robot("/bin/sh",
                       with_closed("<&- >&- 2>&-", "scanloom-robot",
                                   {"--server", server.robot_address(), "--session", "s", "--robot", "r", "simulate"}),
                       place.path() / "progress");
    while (server.get("/api/v1/sessions/s").status != 200 || server.get_json("/api/v1/sessions/s").at("scans") == 0) {
    }
    for (const int number : {0, 1, 2}) EXPECT_EQ(stream_of(robot, number), "/dev/null") << number;
    robot.signal(SIGTERM);
    EXPECT_EQ(robot.wait(), 0);
}

} // namespace
} // namespace scanloom::test

#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/robot_client/lidars/ld06_live_fixture.hpp"

#include <boost/json/parse.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <csignal>
#include <fstream>

/// scanloom-robot as a program.
namespace scanloom::test {
namespace {

using testing::HasSubstr;

/// A named pipe: the test waits for a program's output instead of polling.
class NamedPipe {
public:
    explicit NamedPipe(std::filesystem::path path) : path_(std::move(path)) {
        EXPECT_EQ(::mkfifo(path_.c_str(), 0600), 0);
        descriptor_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    }
    NamedPipe(const NamedPipe&) = delete;
    NamedPipe& operator=(const NamedPipe&) = delete;
    ~NamedPipe() { ::close(descriptor_); }

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    /// Returns the output up to and including this text.
    std::string read_until(const std::string& what) {
        std::string said;
        char byte = 0;
        while (said.find(what) == std::string::npos && ::read(descriptor_, &byte, 1) == 1) said += byte;
        return said;
    }

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
};

TEST(RobotProgram, ALidarWithoutAnyPoseIsReportedAndExitsWith1) {
    const TemporaryDirectory place;
    const RunningServer server(place.path() / "store", place.path() / "log");
    std::ofstream(place.path() / "poses") << "0 0 0 0\n13 1 0 0\n";
    robot::PseudoTerminal lidar;
    lidar.keep_open();
    NamedPipe errors(place.path() / "errors");
    const auto arguments = [&](const std::string& option, const std::string& value) {
        return std::vector<std::string>{"--server", server.robot_address(), "--session", "s",  "--robot", "r",
                                        "ld06",     lidar.device(),         option,      value};
    };
    ChildProcess before(program("scanloom-robot"), arguments("--pose", "1,2,0"), errors.path());
    lidar.send(robot::Ld06Spinner(35'000).next_bytes(80));
    while (server.get("/api/v1/sessions/s").status != 200 || server.get_json("/api/v1/sessions/s").at("scans") != 2) {
    }
    before.signal(SIGINT);
    EXPECT_EQ(before.wait(), 0);

    ChildProcess robot(program("scanloom-robot"), arguments("--pose-file", (place.path() / "poses").string()),
                       errors.path());
    static_cast<void>(errors.read_until("continuing after scan 2")); // the link is established
    lidar.send(robot::Ld06Spinner(35'000).next_bytes(80));
    EXPECT_THAT(errors.read_until("for a device t is Unix time"), HasSubstr("the poses are at t = 13, and the scans"));
    robot.signal(SIGINT);
    const auto summary = robot.read_line();
    EXPECT_EQ(robot.wait(), 1);
    ASSERT_TRUE(summary);
    EXPECT_THAT(*summary, HasSubstr(R"("error":"no scan was sent: none of )"));
}

TEST(RobotProgram, AFileSizeLimitIsReportedAsAnError) {
    const TemporaryDirectory place;
    const auto errors = place.path() / "errors";
    ChildProcess robot("/bin/sh",
                       {"-c", "ulimit -f 2; exec \"$0\" \"$@\"", program("scanloom-robot").string(), "truth", "--world",
                        "office", "--output", (place.path() / "office").string()},
                       errors);
    EXPECT_EQ(robot.wait(), 1);
    std::ifstream file(errors);
    const std::string said{std::istreambuf_iterator<char>(file), {}};
    EXPECT_THAT(said, HasSubstr("office.pgm: the file cannot be written"));
}

} // namespace
} // namespace scanloom::test

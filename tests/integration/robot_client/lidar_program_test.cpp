#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/value.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>

/// scanloom-robot as a program that reads emulated lidars.
namespace scanloom::test {
namespace {

using testing::HasSubstr;

/// An emulated lidar, as a program of its own.
class EmulatedDevice {
public:
    EmulatedDevice(const std::filesystem::path& place, const std::string& model, const std::string& line)
        : process_(program("../tests/lidar_emulator"), {model, line}, place / (model + ".log")),
          address_(process_.read_line().value_or("")) {}

    ~EmulatedDevice() {
        process_.signal(SIGTERM);
        process_.wait();
    }
    EmulatedDevice(const EmulatedDevice&) = delete;
    EmulatedDevice& operator=(const EmulatedDevice&) = delete;

    /// Returns the device as a user names it.
    [[nodiscard]] const std::string& address() const { return address_; }

private:
    ChildProcess process_;
    std::string address_;
};

struct Case {
    const char* model;
    const char* line;
};

class LidarProgram : public testing::TestWithParam<Case> {};

TEST_P(LidarProgram, SendsTheScansOfALidar) {
    const TemporaryDirectory place;
    const RunningServer server(place.path() / "store", place.path() / "log");
    const EmulatedDevice lidar(place.path(), GetParam().model, GetParam().line);
    ChildProcess robot(program("scanloom-robot"),
                       {"--server", server.robot_address(), "--session", "s", "--robot", "r", "lidar", GetParam().model,
                        lidar.address(), "--pose", "1,2,0"},
                       place.path() / "robot");
    const auto scans = [&] {
        if (server.get("/api/v1/sessions/s").status != 200) return 0;
        return server.get_json("/api/v1/sessions/s").at("scans").to_number<int>();
    };
    while (scans() < 3) {
    }
    robot.signal(SIGINT);
    const auto summary = robot.read_line();
    EXPECT_EQ(robot.wait(), 0);
    ASSERT_TRUE(summary);
    EXPECT_THAT(*summary, HasSubstr("0 damaged packets"));
}

INSTANTIATE_TEST_SUITE_P(Models, LidarProgram,
                         testing::Values(Case{"hokuyo", "tcp"}, Case{"rplidar-a1", "serial"},
                                         Case{"ydlidar-x4", "serial"}, Case{"stl27l", "serial"}),
                         [](const auto& each) { return std::string(each.param.model).substr(0, 6); });

TEST(LidarsProgram, ListsLidarsAndSilentDevices) {
    const TemporaryDirectory place;
    const EmulatedDevice hokuyo(place.path(), "hokuyo", "tcp");
    const EmulatedDevice rplidar(place.path(), "rplidar-a2", "serial");
    ChildProcess lidars(program("scanloom-robot"),
                        {"lidars", "--wait", "1", hokuyo.address(), rplidar.address(), "/dev/nonexistent"},
                        place.path() / "errors");
    std::string text;
    while (const auto line = lidars.read_line()) text += *line + "\n";
    EXPECT_EQ(lidars.wait(), 0);
    EXPECT_THAT(text, HasSubstr(hokuyo.address() + ": Hokuyo UST-10LX, firmware CE00486, serial H1234567\n"));
    EXPECT_THAT(text, HasSubstr("lidar hokuyo " + hokuyo.address() + " --poses none\n"));
    EXPECT_THAT(text, HasSubstr(rplidar.address() + ": RPLIDAR A2, model 44, firmware 1.32, serial A0A1"));
    EXPECT_THAT(text, HasSubstr("/dev/nonexistent: cannot be opened"));
}

TEST(LidarsProgram, ExitsWith1WithoutALidar) {
    const TemporaryDirectory place;
    ChildProcess lidars(program("scanloom-robot"), {"lidars", "--wait", "0.01", "/dev/nonexistent"},
                        place.path() / "errors");
    EXPECT_THAT(lidars.read_line().value_or(""), HasSubstr("/dev/nonexistent: cannot be opened"));
    EXPECT_EQ(lidars.wait(), 1);
}

} // namespace
} // namespace scanloom::test

#include "sim/range_sensors.hpp"
#include "sim/world.hpp"
#include "tests/support/ld06_bytes.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/value.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

/// A lidar without odometry, its program and a server, which localizes it by its scans.
namespace scanloom::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::append;
using testing_support::Bytes;
using testing_support::bytes_of;

constexpr std::size_t kBeams = 450; // in one turn of an LD06
constexpr std::size_t kBeamsOfAPacket = 12;

struct Stand {
    Pose2 place;
    int turns; // even, because packets do not end where turns do
};

/// Bytes of an LD06 that is placed at one pose after another, with a sigma of 0.02 m.
Bytes carried(const sim::World& world, const std::vector<Stand>& stands) {
    Sensor laser = sim::find_laser("lidar360").value();
    laser.angles = UniformAngles{0.0, 2.0 * std::numbers::pi / kBeams, kBeams};
    sim::Random random(1);
    std::vector<std::uint16_t> distances; // clockwise, like its rotation
    for (const auto& [place, turns] : stands) {
        for (int turn = 0; turn < turns; ++turn) {
            const auto ranges = sweep(world, laser, place, sim::Noise{}, random);
            for (std::size_t n = 0; n < kBeams; ++n) {
                const RangeMm range = ranges[(kBeams - n) % kBeams];
                distances.push_back(range < 12'000 ? static_cast<std::uint16_t>(range) : std::uint16_t{0});
            }
        }
    }
    testing_support::Ld06Spinner spinner;
    Bytes bytes;
    for (std::size_t first = 0; first + kBeamsOfAPacket <= distances.size(); first += kBeamsOfAPacket) {
        robot::Ld06Packet packet = spinner.next();
        for (std::size_t n = 0; n < kBeamsOfAPacket; ++n) packet.points[n].distance = distances[first + n];
        append(bytes, bytes_of(packet));
    }
    return bytes;
}

constexpr Pose2 kFirst{-3.5, -3.0, 0.3};
constexpr Pose2 kSecond{-3.4, 0.0, 0.5};
constexpr Pose2 kThird{-3.0, -1.5, -2.0};

class LocatingProgramTest : public testing::Test {
protected:
    /// Runs the program on recorded bytes of a lidar. @return its exit code
    int send(const std::string& robot, const Bytes& bytes, const std::vector<std::string>& options) {
        const auto capture = place_.path() / (robot + ".bin");
        std::ofstream(capture, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        std::vector<std::string> words = {"--server", server_.robot_address(), "--session", "lab", "--robot", robot,
                                          "ld06",     capture.string(),        "--locate"};
        words.insert(words.end(), options.begin(), options.end());
        ChildProcess program(test::program("scanloom-robot"), words, place_.path() / robot);
        summary_ = program.read_line().value_or("");
        const int code = program.wait();
        std::ifstream file(place_.path() / robot);
        output_ = {std::istreambuf_iterator<char>(file), {}};
        return code;
    }

    /// Returns the robot's current pose in the map.
    [[nodiscard]] Pose2 pose_of(std::size_t robot) const {
        const auto json = server_.get_json("/api/v1/sessions/lab");
        const auto& pose = json.at("robots").at(robot).at("pose");
        return {pose.at("x").to_number<double>(), pose.at("y").to_number<double>(), pose.at("yaw").to_number<double>()};
    }

    static void expect_near(const Pose2& pose, const Pose2& truth) {
        EXPECT_NEAR(pose.x, truth.x, 0.02);
        EXPECT_NEAR(pose.y, truth.y, 0.02);
        EXPECT_NEAR(normalize_angle(pose.yaw - truth.yaw), 0.0, 0.01);
    }

    TemporaryDirectory place_;
    RunningServer server_{place_.path() / "store", place_.path() / "log"};
    const sim::World room_ = sim::make_room();
    std::string summary_;
    std::string output_; ///< messages for the user
};

TEST_F(LocatingProgramTest, LocalizesEachPlaceAfterTheFirst) {
    ASSERT_EQ(send("carried", carried(room_, {{kFirst, 20}, {kSecond, 20}}), {"--pose", "-3.5,-3,0.3"}), 0) << output_;
    EXPECT_THAT(output_, AllOf(HasSubstr("the map is empty: the lidar's pose is assumed to be (-3.50, -3.00)"),
                               HasSubstr("the lidar was moved"), HasSubstr("localized at (-3.")));
    EXPECT_THAT(summary_, HasSubstr("carried 1 time"));
    expect_near(pose_of(0), kSecond);

    ASSERT_EQ(send("another", carried(room_, {{kThird, 20}}), {"--near", "-3,-1,2"}), 0) << output_;
    EXPECT_THAT(output_, AllOf(HasSubstr("localized at (-3."), Not(HasSubstr("the map is empty"))));
    expect_near(pose_of(1), kThird);
}

TEST_F(LocatingProgramTest, SendsNoScanFromAnUnknownPlace) {
    ASSERT_EQ(send("carried", carried(room_, {{kFirst, 20}}), {}), 0) << output_;
    EXPECT_EQ(send("lost", carried(sim::make_office(), {{{-12.0, 7.0, 0.0}, 20}}), {}), 1);
    EXPECT_THAT(output_, HasSubstr("no scans are sent from here"));
    EXPECT_THAT(summary_, HasSubstr(R"("error":"no scan was sent: )"));
    EXPECT_EQ(server_.get_json("/api/v1/sessions/lab").at("scans").to_number<int>(), 18)
        << "the first and the last turn are incomplete";
}

} // namespace
} // namespace scanloom::test

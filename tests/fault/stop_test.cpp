#include "tests/support/random_scans.hpp"
#include "tests/support/robot_socket.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/temporary_directory.hpp"

#include <boost/json/value.hpp>
#include <gtest/gtest.h>

#include <csignal>

/// A server that receives a stop signal while it has many scans to integrate.
namespace scanloom::test {
namespace {

using testing_support::RobotSocket;

/// A sensor that observes 40 m all around: at 1 cm one scan covers 50 million cells.
Sensor far_laser() {
    Sensor sensor = testing_support::small_laser();
    sensor.angles = UniformAngles{-std::numbers::pi, std::numbers::pi / 180, 360};
    sensor.range_max = 40.0;
    return sensor;
}

std::vector<Scan> far_scans(std::uint64_t first_seq, std::size_t count) {
    auto scans = testing_support::random_scans(1, first_seq, count);
    for (auto& scan : scans) scan.ranges.assign(360, 39'000);
    return scans;
}

/// Joins and describes the laser. @return the last seq that the server already has
std::uint64_t join(RobotSocket& robot) {
    wire::Hello hello{.robot = "r", .session = "far"};
    hello.create = SessionOptions{.cell_size = 0.01};
    robot.send(hello);
    const auto welcome = robot.receive_kind<wire::Welcome>();
    robot.send(far_laser());
    return welcome.last_durable_seq;
}

/// Returns the last acknowledgement before the server closes the connection.
std::uint64_t last_ack(RobotSocket& robot) {
    std::uint64_t acknowledged = 0;
    while (const auto message = robot.receive()) {
        if (const auto* ack = std::get_if<wire::Ack>(&*message)) acknowledged = ack->durable_seq;
    }
    return acknowledged;
}

std::uint64_t applied_scans(const RunningServer& server) {
    return server.get_json("/api/v1/sessions/far").at("scans").to_number<std::uint64_t>();
}

TEST(Stop, SecondSignalStopsIntegrationAndTheNextStartHasEveryAcknowledgedScan) {
    constexpr std::uint64_t kScans = 32; // more than are integrated or in progress at the first ack
    std::uint64_t acknowledged = 0;
    TemporaryDirectory place;
    {
        RunningServer server(place.path() / "store", place.path() / "log");
        RobotSocket robot(server.robot_port());
        ASSERT_EQ(join(robot), 0U);
        robot.send(wire::ScanBatch{far_scans(1, kScans)});
        robot.wait_for_ack(1);
        server.process().signal(SIGTERM);
        while (server.get("/readyz").status == 200) { // two signals at the same time would count as one
        }
        server.process().signal(SIGTERM);
        acknowledged = last_ack(robot);
        EXPECT_EQ(server.process().wait(), 0);
    }
    RunningServer server(place.path() / "store", place.path() / "log");
    RobotSocket robot(server.robot_port());
    const auto stored = join(robot);
    EXPECT_GE(stored, std::max<std::uint64_t>(acknowledged, 1));
    EXPECT_LT(stored, kScans) << "after the second signal the server accepts no more scans";
    EXPECT_EQ(applied_scans(server), stored);
    robot.send(wire::ScanBatch{far_scans(stored + 1, 1)});
    robot.wait_for_ack(stored + 1);
}

} // namespace
} // namespace scanloom::test

#include "tests/fault/lidar_robot.hpp"
#include "tests/support/running_server.hpp"
#include "tests/support/tcp_proxy.hpp"
#include "tests/support/temporary_directory.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace scanloom::fault {
namespace {

/// A live sensor's scans while the network is down and the robot's program is killed once. The row "spool" covers the
/// other cases.
TEST(Outage, LosesNoScanWhenTheProgramIsKilledWithoutNetwork) {
    const TemporaryDirectory place;
    const test::RunningServer server(place.path() / "store", place.path() / "log");
    test::TcpProxy link(server.robot_port());
    const testing_support::Bytes bytes = turns(1, 40);
    const auto quarter = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 4);
    {
        Lidar lidar;
        auto robot = start_lidar_robot(place.path(), link.port(), lidar);
        lidar.wait_for_robot();
        lidar.send({bytes.begin(), quarter});
        wait_for_scans(server.http_port(), 9);

        link.cut();
        lidar.send({quarter, bytes.end()});
        wait_until("40 scans in the spool", [&] { return spooled(place.path()).size() >= 40; });
        robot.signal(SIGKILL);
        EXPECT_EQ(robot.wait(), -SIGKILL);
    }
    Lidar lidar;
    auto robot = start_lidar_robot(place.path(), link.port(), lidar);
    lidar.wait_for_robot();
    lidar.send(turns(41, 60));
    wait_until("60 scans in the spool", [&] { return spooled(place.path()).size() >= 60; });
    EXPECT_LE(scans_of(server.http_port()), 10U) << "the network is down"; // sent before the cut: at most a tenth
    link.restore();
    wait_for_scans(server.http_port(), 60);
    robot.signal(SIGTERM);
    EXPECT_EQ(robot.wait(), 0);
    EXPECT_EQ(scans_of(server.http_port()), 60U);
    EXPECT_EQ(server.get("/api/v1/sessions/s/digest").body, peaceful_digest(60));
    EXPECT_EQ(spooled(place.path()).size(), 0U) << "acknowledged scans must leave the spool";
}

} // namespace
} // namespace scanloom::fault

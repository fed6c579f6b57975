#include "tests/integration/robot_client/client_fixture.hpp"

/// A robot's own program requests the robot's location.
namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class ClientLocate : public ClientFixture {
protected:
    std::unique_ptr<Client> client_of(LinkScript script) {
        server_in_the_test_.go_by(std::move(script));
        server_in_the_test_.run();
        auto made = options();
        made.server = server_in_the_test_.address();
        return Client::start(made).value();
    }

    static std::vector<Scan> scans() {
        std::vector<Scan> made(10, numbered(0));
        for (auto& scan : made) {
            scan.pose = {1.0, 2.0, 0.0};
            scan.ranges.front() = kNoReturn;
        }
        return made;
    }

    ServerInTheTest server_in_the_test_;
};

TEST_F(ClientLocate, ReturnsTheServersPose) {
    const auto client = client_of({.location = wire::Correction{{1.0, 2.0, 3.0}, 7, 0.9, 0.01, 0.02}});
    const auto location = client->locate(laser(), scans(), 20s, {.near = {{{4.0, 5.0}, 6.0}}});
    ASSERT_TRUE(location) << location.error().message;
    EXPECT_EQ(location->T_map_odom, (Pose2{1.0, 2.0, 3.0}));
    EXPECT_EQ(location->inlier_ratio, 0.9);
    EXPECT_EQ(location->explained, 0.9) << "the earlier name";
    EXPECT_EQ(location->position_sigma, 0.01);
    EXPECT_EQ(location->yaw_sigma, 0.02);
    EXPECT_EQ(location->revision, 7U);
    EXPECT_TRUE(client->close(20s));
    ASSERT_EQ(server_in_the_test_.fake().locates().size(), 1U);
    const auto& asked = server_in_the_test_.fake().locates()[0];
    EXPECT_EQ(asked.points.size(), 10U * 199U);
    EXPECT_EQ(asked.from, (Point2{1.0, 2.0}));
    EXPECT_EQ(asked.near, (wire::Near{{4.0, 5.0}, 6.0}));
    EXPECT_TRUE(server_in_the_test_.fake().stored().empty()) << "the scans of a request are not stored";
}

TEST_F(ClientLocate, PassesCorrectionsOnAndKeepsTheNewest) {
    const wire::Correction first{{1.0, 2.0, 3.0}, 7, 0.9, 0.01, 0.02, LocalizationState::kTracking};
    const wire::Correction second{{4.0, 5.0, -1.0}, 8, 0.2, 0.03, 0.04, LocalizationState::kLost};
    server_in_the_test_.go_by({.corrections = {first, second}});
    std::vector<Pose2> received;
    auto made = options();
    made.server = server_in_the_test_.address();
    made.poses = Poses::kOdometry;
    made.on_correction = [&](const Location& location) { received.push_back(location.T_map_odom); };
    const auto client = Client::start(made).value();
    EXPECT_FALSE(client->transform()) << "the server does not answer yet";
    server_in_the_test_.run();
    Scan scan = numbered(1);
    scan.odometry = std::exchange(scan.pose, std::nullopt);
    EXPECT_TRUE(client->send(laser(), scan));
    EXPECT_TRUE(client->close(20s));
    EXPECT_THAT(received, testing::ElementsAre(first.T_map_odom, second.T_map_odom));
    const auto newest = client->transform();
    ASSERT_TRUE(newest) << "it is kept when the link has ended";
    EXPECT_EQ(newest->T_map_odom, second.T_map_odom);
    EXPECT_EQ(newest->revision, 8U);
    EXPECT_EQ(newest->inlier_ratio, 0.2);
    EXPECT_EQ(newest->position_sigma, 0.03);
    EXPECT_EQ(newest->yaw_sigma, 0.04);
    EXPECT_EQ(newest->state, LocalizationState::kLost);
}

TEST_F(ClientLocate, ReturnsTheServersRefusal) {
    const Error refusal{Errc::kUndetermined, "too little of the scan is in the map"};
    const auto client = client_of({.location = refusal});
    EXPECT_EQ(client->locate(laser(), scans(), 20s).error(), refusal);
    send(*client, 1, 1);
    EXPECT_TRUE(client->close(20s));
}

TEST_F(ClientLocate, ReportsAServerOfAnEarlierVersion) {
    const auto client = client_of({.knows_locating = false});
    EXPECT_THAT(client->locate(laser(), scans(), 20s).error().message, HasSubstr("servers of earlier versions"));
}

TEST_F(ClientLocate, TimesOutWithoutAServer) {
    const auto client = Client::start(options()).value();
    EXPECT_EQ(client->locate(laser(), scans(), 1ms).error().code, Errc::kTimeout);
}

TEST_F(ClientLocate, RefusesInvalidArgumentsByName) {
    const auto client = client_of({});
    const auto refused = [&](const std::shared_ptr<const Sensor>& sensor, const std::vector<Scan>& given,
                             const char* message, const LocateOptions& within = {}) {
        const auto location = client->locate(sensor, given, 20s, within);
        ASSERT_FALSE(location) << message;
        EXPECT_EQ(location.error().code, Errc::kInvalidField);
        EXPECT_THAT(location.error().message, HasSubstr(message));
    };
    refused(nullptr, scans(), "needs the sensor of the scans");
    refused(laser(), {}, "have 0 returns; at least 20 are needed");
    Sensor sonar = *laser();
    sonar.kind = SensorKind::kSonar;
    refused(std::make_shared<const Sensor>(sonar), scans(), "needs laser scans; this sensor is a sonar");
    auto wrong = scans();
    wrong[3].pose->x = std::numeric_limits<double>::quiet_NaN();
    refused(laser(), wrong, "scans[3]: ");
    refused(laser(), scans(), "radius is 0 m", {.near = {{{0.0, 0.0}, 0.0}}});
    refused(laser(), scans(), "near.x is 2000000", {.near = {{{2e6, 0.0}, 1.0}}});
    EXPECT_TRUE(client->locate(laser(), scans(), 20s));
    EXPECT_TRUE(client->close(20s));
    EXPECT_EQ(server_in_the_test_.fake().locates().size(), 1U);
}

} // namespace
} // namespace scanloom::robot

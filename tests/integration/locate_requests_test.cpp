#include "tests/integration/ingest_fixture.hpp"
#include "tests/support/room_scans.hpp"

#include <boost/asio/post.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <future>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

/// Robots that request their location.
namespace scanloom::ingest {
namespace {

using testing::HasSubstr;
using testing_support::room_range;

constexpr std::uint32_t kBeams = 720;

Sensor round_laser() {
    Sensor sensor;
    sensor.id = 1;
    sensor.name = "laser";
    sensor.mount = {0.1, 0.0, 0.0};
    sensor.angles = UniformAngles{0.0, 2.0 * std::numbers::pi / kBeams, kBeams};
    sensor.range_max = 20.0;
    return sensor;
}

/// Returns the observed points of the room from a pose, beam by beam, in metres.
std::vector<double> room_from(const Pose2& T_room_laser) {
    std::vector<double> ranges;
    for (std::uint32_t n = 0; n < kBeams; ++n) {
        const double direction = T_room_laser.yaw + n * 2.0 * std::numbers::pi / kBeams;
        ranges.push_back(room_range({T_room_laser.x, T_room_laser.y}, direction));
    }
    return ranges;
}

Scan room_scan(std::uint64_t seq, const Pose2& T_map_robot) {
    Scan scan{.seq = seq, .stamp = static_cast<double>(seq), .sensor = 1, .pose = T_map_robot};
    for (const double metres : room_from(compose(T_map_robot, round_laser().mount))) {
        scan.ranges.push_back(static_cast<RangeMm>(std::lround(metres * 1e3)));
    }
    return scan;
}

/// Returns the request of a lidar at a pose, in its own frame.
wire::LocateRequest question_from(const Pose2& T_room_laser, std::uint64_t id = 1) {
    wire::LocateRequest request{.id = id};
    const auto ranges = room_from(T_room_laser);
    for (std::uint32_t n = 0; n < kBeams; ++n) {
        const double angle = n * 2.0 * std::numbers::pi / kBeams;
        request.points.push_back({static_cast<std::int32_t>(std::lround(ranges[n] * 1e3 * std::cos(angle))),
                                  static_cast<std::int32_t>(std::lround(ranges[n] * 1e3 * std::sin(angle)))});
    }
    return request;
}

constexpr Pose2 kTruth{2.0, 1.5, 0.7};

class LocateRequestsTest : public IngestTest {
protected:
    /// A robot that has sent scans from two places, fewer than a full capture from each.
    std::unique_ptr<RobotSocket> mapping(const std::string& name = "mapper") {
        auto robot = welcomed(port(), hello(name));
        robot->send(round_laser());
        robot->send(wire::ScanBatch{{room_scan(1, {-2.0, -1.0, 0.4}), room_scan(2, {1.0, 2.0, -2.0})}});
        robot->wait_for_ack(2);
        return robot;
    }
};

TEST_F(LocateRequestsTest, ALidarWithoutOdometryIsLocalized) {
    auto& ingest = start();
    const auto mapper = mapping();
    const auto carried = welcomed(port(), hello("carried"));
    carried->send(question_from(kTruth, 7));
    const auto reply = carried->receive_kind<wire::LocateReply>();
    EXPECT_EQ(reply.id, 7U);
    EXPECT_EQ(reply.revision, ingest.snapshot("lab")->revision);
    ASSERT_TRUE(reply.result) << reply.result.error().message;
    EXPECT_NEAR(reply.result->T_map_odom.x, kTruth.x, 0.02);
    EXPECT_NEAR(reply.result->T_map_odom.y, kTruth.y, 0.02);
    EXPECT_NEAR(reply.result->T_map_odom.yaw, kTruth.yaw, 0.005);
    EXPECT_EQ(reply.result->revision, reply.revision);
    EXPECT_GT(reply.result->explained, 0.9);
    EXPECT_LT(reply.result->position_sigma, 0.01);
}

TEST_F(LocateRequestsTest, LocateRequestsAreNotStored) {
    auto& ingest = start();
    const auto mapper = mapping();
    const auto carried = welcomed(port(), hello("carried"));
    const auto before = ingest.snapshot("lab")->revision;
    carried->send(question_from(kTruth));
    EXPECT_TRUE(carried->receive_kind<wire::LocateReply>().result);
    EXPECT_EQ(ingest.snapshot("lab")->revision, before);
}

TEST_F(LocateRequestsTest, AnAmbiguousPoseIsRefusedAndTheLinkContinues) {
    start();
    const auto carried = welcomed(port(), hello("carried"));
    carried->send(question_from(kTruth, 1));
    EXPECT_EQ(carried->receive_kind<wire::LocateReply>().result.error().code, Errc::kNothingMapped);

    const auto mapper = mapping();
    auto elsewhere = question_from(kTruth, 2);
    for (auto& point : elsewhere.points) point = {point.x / 3, point.y / 3}; // a small room
    carried->send(elsewhere);
    EXPECT_EQ(carried->receive_kind<wire::LocateReply>().result.error().code, Errc::kUndetermined);

    auto wall = question_from(kTruth, 3);
    for (std::size_t n = 0; n < wall.points.size(); ++n) wall.points[n] = {static_cast<std::int32_t>(n), 1000};
    carried->send(wall);
    const auto refused = carried->receive_kind<wire::LocateReply>().result.error();
    EXPECT_TRUE(refused.code == Errc::kAmbiguous || refused.code == Errc::kUndetermined) << refused.message;

    auto far = question_from(kTruth, 4);
    far.near = wire::Near{{500.0, 0.0}, 10.0};
    carried->send(far);
    const auto nothing = carried->receive_kind<wire::LocateReply>().result.error();
    EXPECT_EQ(nothing.code, Errc::kUndetermined);
    EXPECT_THAT(nothing.message, HasSubstr("within 10 m of (500, 0)"));

    auto near = question_from(kTruth, 5);
    near.near = wire::Near{{1.5, 1.0}, 2.0};
    carried->send(near);
    EXPECT_TRUE(carried->receive_kind<wire::LocateReply>().result);
}

TEST_F(LocateRequestsTest, OnAnEmptyMapOnlyOneOfTwoRobotsMayBeginIt) {
    start();
    const auto first = welcomed(port(), hello("first"));
    const auto second = welcomed(port(), hello("second"));
    first->send(question_from(kTruth, 1));
    EXPECT_EQ(first->receive_kind<wire::LocateReply>().result.error().code, Errc::kNothingMapped);
    second->send(question_from(kTruth, 1));
    const auto refused = second->receive_kind<wire::LocateReply>().result.error();
    EXPECT_EQ(refused.code, Errc::kOverloaded) << "the robot may retry";
    EXPECT_THAT(refused.message, HasSubstr("asked to begin the map at its own pose"));

    first->send(round_laser());
    first->send(wire::ScanBatch{{room_scan(1, {-2.0, -1.0, 0.4}), room_scan(2, {1.0, 2.0, -2.0})}});
    first->wait_for_ack(2);
    second->send(question_from(kTruth, 2));
    const auto reply = second->receive_kind<wire::LocateReply>();
    EXPECT_TRUE(reply.result) << reply.result.error().message;
}

TEST_F(LocateRequestsTest, ManyLocateRequestsDoNotBlockPlanRequests) {
    auto& ingest = start();
    const auto mapper = mapping();
    std::promise<void> go_on;
    boost::asio::post(ingest.locating(), [wait = go_on.get_future().share()] { wait.wait(); });
    std::vector<std::unique_ptr<RobotSocket>> carried;
    for (std::size_t n = 0; n < RequestExecutor::kLocatingMax / 4; ++n) { // four of each at a time
        carried.push_back(welcomed(port(), hello("carried" + std::to_string(n))));
        for (std::uint64_t id = 1; id <= 4; ++id) carried.back()->send(question_from(kTruth, id));
        carried.back()->send(wire::Ping{n});
        EXPECT_EQ(carried.back()->receive_kind<wire::Pong>().nonce, n);
    }
    const auto late = welcomed(port(), hello("late"));
    late->send(question_from(kTruth));
    EXPECT_EQ(late->receive_kind<wire::LocateReply>().result.error().code, Errc::kOverloaded);
    mapper->send(wire::PlanRequest{.id = 9, .goal = {1.0, 2.5}});
    EXPECT_TRUE(mapper->receive_kind<wire::PlanReply>().result);
    go_on.set_value();
}

TEST_F(LocateRequestsTest, ANewRobotIsLocalizedInItsOwnMap) {
    start();
    const auto robot = welcomed(port(), hello("r"));
    robot->send(round_laser());
    robot->send(wire::ScanBatch{{room_scan(1, {-2.0, -1.0, 0.4})}});
    robot->wait_for_ack(1);
    robot->send(question_from({-1.0, -1.8, 2.5}));
    const auto reply = robot->receive_kind<wire::LocateReply>();
    EXPECT_TRUE(reply.result) << reply.result.error().message;
}

/// Robots are localized in the laser map: an imported map is not empty, and no robot begins another one in it.
TEST_F(LocateRequestsTest, ARobotMayNotBeginAnImportedMap) {
    auto& ingest = start();
    const MapPatch patch{0.1, 0.0, 0.0, 2, {MapCell::kOccupied, MapCell::kFree}};
    ASSERT_TRUE(ingest.sessions().import_map("lab", {}, {patch}));
    const auto carried = welcomed(port(), hello("carried"));
    carried->send(question_from(kTruth));
    const auto refused = carried->receive_kind<wire::LocateReply>().result.error();
    EXPECT_EQ(refused.code, Errc::kUndetermined);
    EXPECT_THAT(refused.message, HasSubstr("send the first scans from a known pose"));
}

/// On an empty map, the first robot with that reply begins the map: a robot that has disconnected gets no reply.
TEST_F(LocateRequestsTest, AClosedLinkDoesNotDelayOthers) {
    auto& ingest = start();
    std::promise<void> go_on;
    boost::asio::post(ingest.locating(), [wait = go_on.get_future().share()] { wait.wait(); });
    {
        const auto hasty = welcomed(port(), hello("hasty"));
        hasty->send(question_from(kTruth));
        hasty->send(wire::Ping{3});
        EXPECT_EQ(hasty->receive_kind<wire::Pong>().nonce, 3U) << "the request has been read";
    }
    while (ingest.sessions().find("lab")->is_connected(0)) std::this_thread::yield();
    const auto patient = welcomed(port(), hello("patient"));
    patient->send(question_from(kTruth));
    go_on.set_value();
    EXPECT_EQ(patient->receive_kind<wire::LocateReply>().result.error().code, Errc::kNothingMapped);
}

} // namespace
} // namespace scanloom::ingest

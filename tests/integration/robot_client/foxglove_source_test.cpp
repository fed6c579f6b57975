#include "common/net/tls.hpp"
#include "tests/integration/robot_client/foxglove_fixture.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/test_certificate.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

class FoxgloveEncodings : public FoxgloveFixture, public testing::WithParamInterface<MessageEncoding> {};

TEST_P(FoxgloveEncodings, ScansHaveThePosesAndMountsOfTheTransforms) {
    start_bridge();
    const auto robot = advertise_robot(GetParam());
    make_source();
    EXPECT_EQ(prepare(robot).value(), Poses::kOdometry);
    const auto next = next_of();
    ASSERT_TRUE(next && *next);
    EXPECT_NEAR((*next)->scan.odometry->x, 0.5, 1e-9);
    EXPECT_EQ((*next)->sensor->mount, (Pose2{0.25, 0.0, 0.0}));
    EXPECT_EQ((*next)->scan.stamp, static_cast<double>(stamp(0) + kScanPeriod / 2) / 1e9);
    EXPECT_EQ((*next)->scan.ranges, std::vector<RangeMm>(5, 2000));
    send_scan(robot, 1);
    send_pose(robot, 2);
    EXPECT_NEAR(next_x(), 1.5, 1e-9);
    EXPECT_EQ(source_->remarks(), "");
    EXPECT_EQ(bridge_->offered(), "foxglove.sdk.v1, foxglove.websocket.v1");
    EXPECT_TRUE(has_note("poses: odometry, of base in odom, by the transforms"));
}

INSTANTIATE_TEST_SUITE_P(Each, FoxgloveEncodings, testing::Values(MessageEncoding::kRos1, MessageEncoding::kCdr));

class FoxgloveSourceTest : public FoxgloveFixture {
protected:
    /// Starts the source with a robot whose first scan is taken.
    Robot begin(FakeBridge::Options bridge = {}) {
        start_bridge(std::move(bridge));
        const auto robot = advertise_robot();
        make_source();
        const auto poses = prepare(robot);
        EXPECT_TRUE(poses) << poses.error().message;
        EXPECT_NEAR(next_x(), 0.5, 1e-9);
        return robot;
    }
};

TEST_F(FoxgloveSourceTest, ABridgeOfTheOlderSubprotocolIsRead) { begin({.subprotocol = "foxglove.websocket.v1"}); }

TEST_F(FoxgloveSourceTest, ABridgeThatSpeaksNeitherSubprotocolIsAnErrorAtOnce) {
    const std::pair<FakeBridge::Options, const char*> cases[] = {
        {{.refusal = 400}, "answers the WebSocket handshake with 400"},
        {{.refusal = 404}, "answers the WebSocket handshake with 404"},
        {{.subprotocol = ""}, "accepts none of the sub-protocols"},
        {{.subprotocol = "rosbridge.v2"}, "accepts none of the sub-protocols"},
        {{.greeting = ""}, "sends no serverInfo within 0.05 s"},
        {{.greeting = R"({"op":"publish"})"}, "sends no serverInfo within 0.05 s"},
    };
    for (const auto& [bridge, what] : cases) {
        start_bridge(bridge);
        auto stated = options();
        stated.link.info_max = 50ms;
        make_source(std::move(stated));
        const auto poses = prepare();
        ASSERT_FALSE(poses) << what;
        EXPECT_EQ(poses.error().code, Errc::kUnsupportedVersion);
        EXPECT_THAT(poses.error().message, HasSubstr(what));
        EXPECT_THAT(poses.error().message, HasSubstr("it speaks neither of foxglove.sdk.v1, foxglove.websocket.v1"));
        EXPECT_THAT(notes_, testing::IsEmpty());
    }
}

TEST_F(FoxgloveSourceTest, AServerThatIsNoWebSocketIsAnErrorAtOnce) {
    asio::ip::tcp::acceptor acceptor(io_, {asio::ip::address_v4::loopback(), 0});
    port_ = acceptor.local_endpoint().port();
    asio::ip::tcp::socket accepted(io_);
    const std::string greeting = "SSH-2.0-OpenSSH_9.2\r\n";
    acceptor.async_accept(accepted, [&](boost::system::error_code) { asio::write(accepted, asio::buffer(greeting)); });
    make_source();
    const auto poses = prepare();
    ASSERT_FALSE(poses);
    EXPECT_EQ(poses.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(poses.error().message, HasSubstr("does not answer as a WebSocket"));
}

TEST_F(FoxgloveSourceTest, ABridgeThatIsNotThereIsTriedForSomeTime) {
    start_bridge();
    bridge_.reset(); // its port is free
    auto stated = options();
    stated.link.reopen_for = 20ms;
    make_source(std::move(stated));
    const auto poses = prepare();
    ASSERT_FALSE(poses);
    EXPECT_EQ(poses.error().code, Errc::kUnreachable);
    EXPECT_THAT(poses.error().message, HasSubstr("is foxglove_bridge running there? (retried for 0.02 s)"));
    EXPECT_TRUE(has_note("Retrying for 0.02 s"));
}

TEST_F(FoxgloveSourceTest, AProxyWhoseBridgeIsNotThereIsTriedForSomeTime) {
    start_bridge({.refusal = 503});
    auto stated = options();
    stated.link.reopen_for = 20ms;
    make_source(std::move(stated));
    const auto poses = prepare();
    ASSERT_FALSE(poses);
    EXPECT_EQ(poses.error().code, Errc::kUnreachable);
    EXPECT_THAT(poses.error().message, HasSubstr("with 503; is the bridge behind this proxy running? (retried"));
}

/// As one that wants a token.
TEST_F(FoxgloveSourceTest, ABridgeThatClosesEachConnectionSoonIsTriedForSomeTime) {
    start_bridge();
    auto stated = options();
    stated.link.reopen_for = 20ms;
    stated.link.steady_after = 1h;
    make_source(std::move(stated));
    const auto poses = prepare([&] { bridge_->drop_clients(); });
    ASSERT_FALSE(poses);
    EXPECT_EQ(poses.error().code, Errc::kUnreachable);
    EXPECT_GT(bridge_->connections(), 1U);
    EXPECT_LE(notes_.size(), 2U) << "not two for each connection";
}

TEST_F(FoxgloveSourceTest, WithoutPrepareTheFirstNextSurveysTheRobot) {
    start_bridge();
    const auto robot = advertise_robot();
    make_source();
    source_->expect_poses(Poses::kNone);
    begin_next();
    wait_for_subscriptions(robot);
    send_scan(robot, 0);
    run_until([this] { return next_.has_value(); });
    ASSERT_TRUE(*next_ && **next_);
    EXPECT_FALSE((**next_)->scan.odometry) << "as expected";
}

TEST_F(FoxgloveSourceTest, ALaserThatStopsIsNoted) {
    start_bridge();
    const auto robot = advertise_robot();
    auto stated = options();
    stated.silent_noted_after = 10ms;
    make_source(std::move(stated));
    ASSERT_TRUE(prepare(robot));
    EXPECT_NEAR(next_x(), 0.5, 1e-9);
    begin_next();
    run_until([&] { return has_note("no scan has come for 0.01 s; is the laser running?"); });
    send_scan(robot, 1);
    send_pose(robot, 2);
    run_until([this] { return next_.has_value(); });
    EXPECT_TRUE(has_note("scans come again"));
}

TEST_F(FoxgloveSourceTest, ABridgeMayStartAfterTheSource) {
    start_bridge();
    bridge_.reset();
    make_source();
    std::optional<Result<Poses>> poses;
    asio::co_spawn(io_, source_->prepare(), [&](std::exception_ptr, Result<Poses> result) { poses = result; });
    run_until([&] { return !notes_.empty(); });
    start_bridge({.port = port_});
    const auto robot = advertise_robot();
    wait_for_subscriptions(robot);
    send_scan(robot, 0);
    run_until([&] { return poses.has_value(); });
    EXPECT_EQ(poses->value(), Poses::kNone);
    EXPECT_TRUE(has_note(": connected"));
}

TEST_F(FoxgloveSourceTest, ALostConnectionIsReplacedAndNoScanThatWasSentIsLost) {
    const auto robot = begin();
    for (int n = 1; n < 5; ++n) {
        send_scan(robot, n); // its pose comes on the next connection
        const auto mark = fmt::format("mark {}", n);
        bridge_->send_text(fmt::format(R"({{"op":"status","level":1,"message":"{}"}})", mark));
        run_until([&] { return has_note(mark); });
        begin_next();
        bridge_->drop_clients();
        run_until([&] { return bridge_->connections() == static_cast<std::size_t>(n) + 1; });
        wait_for_subscriptions(robot);
        send_pose(robot, n + 1);
        run_until([&] { return next_.has_value(); });
        ASSERT_TRUE(*next_ && **next_);
        EXPECT_NEAR((**next_)->scan.odometry->x, n + 0.5, 1e-9);
    }
    EXPECT_TRUE(has_note("has closed the connection"));
    EXPECT_TRUE(has_note(": connected again"));
    EXPECT_EQ(source_->remarks(), "connected to the bridge 5 times, 4 warnings of the bridge");
}

TEST_F(FoxgloveSourceTest, AConnectionThatDoesNotAnswerPingsIsReplaced) {
    start_bridge({.is_deaf = true});
    auto stated = options();
    stated.link.silent_max = 20ms;
    make_source(std::move(stated));
    asio::co_spawn(io_, source_->prepare(), [](std::exception_ptr, Result<Poses>) {});
    run_until([&] { return bridge_->connections() >= 2; });
    EXPECT_TRUE(has_note("has not answered for 0.02 s; check the network"));
}

TEST_F(FoxgloveSourceTest, ARestartedBridgeWithOtherIdsIsReadOn) {
    auto robot = begin();
    bridge_.reset();
    start_bridge({.port = port_});
    bridge_->advertise("/other", "ros1", "sensor_msgs/LaserScan");
    robot = advertise_robot();
    wait_for_subscriptions(robot);
    send_scan(robot, 1);
    send_pose(robot, 2);
    EXPECT_NEAR(next_x(), 1.5, 1e-9);
    EXPECT_TRUE(has_note("/other: this laser appeared after the survey of the robot"));
}

TEST_F(FoxgloveSourceTest, ABridgeThatStaysAwayEndsTheSourceOnceAllScansAreTaken) {
    start_bridge();
    const auto robot = advertise_robot();
    auto stated = options();
    stated.link.reopen_for = 20ms;
    make_source(std::move(stated));
    ASSERT_TRUE(prepare(robot));
    bridge_.reset();
    EXPECT_NEAR(next_x(), 0.5, 1e-9);
    const auto next = next_of();
    ASSERT_FALSE(next);
    EXPECT_EQ(next.error().code, Errc::kUnreachable);
}

TEST_F(FoxgloveSourceTest, TopicsThatVanishAndComeBackAreReadOn) {
    auto robot = begin();
    bridge_->unadvertise(robot.scan);
    bridge_->unadvertise(robot.tf);
    robot.tf = bridge_->advertise("/tf", "ros1", "tf2_msgs/TFMessage");
    robot.scan = bridge_->advertise("/scan", "ros1", "sensor_msgs/LaserScan");
    wait_for_subscriptions(robot);
    send_scan(robot, 1);
    send_pose(robot, 2);
    EXPECT_NEAR(next_x(), 1.5, 1e-9);
    EXPECT_EQ(source_->remarks(), "");
}

TEST_F(FoxgloveSourceTest, WhatIsNotUsedIsUnsubscribed) {
    start_bridge();
    const auto robot = advertise_robot();
    const auto odom = bridge_->advertise("/odom", "ros1", "nav_msgs/Odometry");
    const auto image = bridge_->advertise("/image", "ros1", "sensor_msgs/Image");
    make_source();
    ASSERT_TRUE(prepare(robot));
    run_until([&] { return !bridge_->is_subscribed(odom); });
    EXPECT_TRUE(bridge_->is_subscribed(robot.scan));
    EXPECT_FALSE(bridge_->is_subscribed(image));
}

TEST_F(FoxgloveSourceTest, AScanWithoutItsTransformIsSkippedAndCounted) {
    start_bridge();
    const auto robot = advertise_robot();
    auto stated = options();
    stated.scans.transform_wait = 5ms;
    make_source(std::move(stated));
    const auto poses = prepare([&] {
        if (!bridge_->is_subscribed(robot.scan) || !bridge_->is_subscribed(robot.tf_static)) return;
        bridge_->on_change = [] {};
        send_static(robot);
        send_pose(robot, 0);
        send_pose(robot, 1);
        send_scan(robot, 0);
    });
    ASSERT_TRUE(poses);
    EXPECT_NEAR(next_x(), 0.5, 1e-9);
    send_scan(robot, 1);
    begin_next();
    run_until([&] { return !source_->skipped().empty(); });
    EXPECT_THAT(source_->skipped(), testing::ElementsAre(testing::Pair("after the last pose", 1)));
    EXPECT_EQ(source_->remarks(), "skipped: 1 after the last pose");
    source_->stop();
    run_until([&] { return next_.has_value(); });
}

TEST_F(FoxgloveSourceTest, HostileFramesAreCountedAndTheConnectionIsKept) {
    const auto robot = begin();
    bridge_->send_text("nonsense");
    bridge_->send_text(std::string(5000, '['));
    bridge_->send_binary("\x01\x02");
    bridge_->send_binary("");
    bridge_->send_text(R"({"op":"advertise","channels":[7]})");
    send_scan(robot, 1);
    send_pose(robot, 2);
    EXPECT_NEAR(next_x(), 1.5, 1e-9);
    EXPECT_EQ(bridge_->connections(), 1U);
    EXPECT_EQ(source_->lost_parts(), 5U);
    EXPECT_EQ(source_->remarks(), "refused frames: 1 a channel without id, topic, encoding or schema, 1 a short "
                                  "message, 2 a text frame that is no JSON object, 1 an empty binary frame");
}

TEST_F(FoxgloveSourceTest, WarningsOfTheBridgeAreNotedOnce) {
    const auto robot = begin();
    for (int n = 0; n < 3; ++n) {
        bridge_->send_text(R"({"op":"status","level":1,"message":"Send buffer limit reached\u001b[2J"})");
    }
    bridge_->send_text(R"({"op":"status","level":0,"message":"hello"})");
    send_scan(robot, 1);
    send_pose(robot, 2);
    next_x();
    EXPECT_EQ(std::ranges::count(notes_, "the bridge reports: Send buffer limit reached?[2J"), 1);
    EXPECT_FALSE(has_note("hello"));
    EXPECT_EQ(source_->remarks(), "3 warnings of the bridge");
}

TEST_F(FoxgloveSourceTest, WhatItWaitsForIsNoted) {
    start_bridge();
    const auto robot = advertise_robot();
    auto stated = options();
    stated.scans.robot.topics = {"/rear"};
    stated.waiting_noted_after = 1ms;
    make_source(std::move(stated));
    asio::co_spawn(io_, source_->prepare(), [](std::exception_ptr, Result<Poses>) {});
    run_until([&] { return !notes_.empty(); });
    EXPECT_THAT(notes_.front(),
                HasSubstr("waiting for scans of /rear; topics of lasers that the bridge offers: /scan"));
    EXPECT_FALSE(bridge_->is_subscribed(robot.scan));
}

TEST_F(FoxgloveSourceTest, StoppingEndsTheSourceAndItsConnection) {
    const auto robot = begin();
    begin_next();
    io_.restart();
    io_.poll();
    source_->stop();
    run_until([&] { return next_.has_value(); });
    EXPECT_TRUE(*next_ && !**next_) << "no more scans";
    run_until([&] { return !bridge_->is_subscribed(robot.scan); });
}

TEST_F(FoxgloveSourceTest, WssIsEncryptedAndItsCertificateIsVerified) {
    const TemporaryDirectory directory;
    const auto files = testing_support::write_certificate(directory.path(), "127.0.0.1");
    const auto server = net::server_tls({files.certificate.string(), files.key.string()}).value();
    start_bridge({.tls = server.get()});
    const auto robot = advertise_robot();
    auto stated = options();
    stated.link.bridge = parse_url(fmt::format("wss://127.0.0.1:{}", port_), kWebSocketUrl).value();
    stated.link.tls = net::client_tls(files.certificate.string()).value();
    make_source(stated);
    ASSERT_TRUE(prepare(robot));
    EXPECT_NEAR(next_x(), 0.5, 1e-9);

    stated.link.tls = net::client_tls("").value();
    stated.link.reopen_for = 0ms;
    make_source(std::move(stated));
    const auto refused = prepare();
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("certificate"));
}

} // namespace
} // namespace scanloom::robot

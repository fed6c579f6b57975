#include "common/net/await_tuple.hpp"
#include "tests/integration/robot_client/foxglove_fixture.hpp"

#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>

#include <array>
#include <bit>
#include <map>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;
using testing_support::PublishedMessage;

/// A server of HTTP whose answers the test states.
class FakeMapServer {
public:
    struct Answer {
        unsigned status = 404;
        std::string etag;
        std::string body;
    };

    explicit FakeMapServer(asio::io_context& io) : acceptor_(io, {asio::ip::address_v4::loopback(), 0}) {
        asio::co_spawn(io, serve(), asio::detached);
    }

    [[nodiscard]] net::HttpPlace place(const std::string& token = "") const {
        return {{"127.0.0.1", std::to_string(acceptor_.local_endpoint().port())}, nullptr, token, ""};
    }

    std::map<std::string, Answer> answers; // by the name of the file
    std::vector<std::string> requests;     // targets, with "if changed" behind conditional ones
    std::string authorization;             // of the last request
    std::function<void()> on_request = [] {};

private:
    asio::awaitable<void> serve() {
        for (;;) {
            asio::ip::tcp::socket socket(acceptor_.get_executor());
            if (std::get<0>(co_await acceptor_.async_accept(socket, kAwaitTuple))) co_return;
            boost::beast::flat_buffer buffer;
            for (;;) {
                namespace http = boost::beast::http;
                http::request<http::string_body> request;
                if (std::get<0>(co_await http::async_read(socket, buffer, request, kAwaitTuple))) break;
                const std::string target(request.target());
                const std::string known(request[http::field::if_none_match]);
                requests.push_back(target + (known.empty() ? "" : " if changed"));
                authorization = std::string(request[http::field::authorization]);
                const auto notify = on_request; // which may replace itself
                notify();
                const Answer& found = answers[target.substr(target.rfind('/') + 1)];
                const bool is_known = !known.empty() && known == found.etag;
                http::response<http::string_body> answer(static_cast<http::status>(is_known ? 304 : found.status), 11);
                answer.set(http::field::etag, found.etag);
                if (!is_known) answer.body() = found.body;
                answer.prepare_payload();
                if (std::get<0>(co_await http::async_write(socket, answer, kAwaitTuple))) break;
            }
        }
    }

    asio::ip::tcp::acceptor acceptor_;
};

class RobotPublisherTest : public FoxgloveFixture {
protected:
    /// Connects to a bridge that lets clients publish, and publishes the transform from there on.
    void start_publishing(const std::string& map_frame = "map") {
        start_bridge();
        robot_ = advertise_robot();
        auto stated = options();
        stated.publish.transform = true;
        stated.publish.map_frame = map_frame;
        make_source(std::move(stated));
        ASSERT_TRUE(prepare(robot_));
    }

    [[nodiscard]] std::vector<RosTransform> transforms() const {
        std::vector<RosTransform> all;
        std::size_t left_out = 0;
        for (const auto& message : bridge_->published()) {
            if (message.topic != "/tf") continue;
            const auto encoding = message.encoding == "cdr" ? MessageEncoding::kCdr : MessageEncoding::kRos1;
            for (const auto& one : decode_transforms(message.payload, encoding, left_out).value()) all.push_back(one);
        }
        return all;
    }

    Robot robot_;
};

/// The same bridge again, at its port.
FakeBridge::Options at(std::uint16_t port, std::string greeting = FakeBridge::Options().greeting) {
    return {.greeting = std::move(greeting), .port = port};
}

TEST_F(RobotPublisherTest, TheTransformIsPublishedWithRisingStampsOfTheRobotsClock) {
    start_publishing("world_map");
    source_->correct(Pose2{1.0, 2.0, 0.5});
    run_until([&] { return transforms().size() >= 20; });
    source_->correct(Pose2{3.0, 2.0, 0.5});
    run_until([&] { return transforms().back().T_parent_child.translation().x() == 3.0; });
    const auto all = transforms();
    for (std::size_t n = 0; n < all.size(); ++n) {
        EXPECT_EQ(all[n].header.frame, "world_map");
        EXPECT_EQ(all[n].child, "odom");
        if (n > 0) {
            EXPECT_GT(all[n].header.stamp, all[n - 1].header.stamp);
        }
    }
    EXPECT_EQ(all.front().T_parent_child.translation(), Eigen::Vector3d(1.0, 2.0, 0.0));
    EXPECT_GE(all.front().header.stamp, stamp(0) + kScanPeriod / 2) << "years before this machine's clock";
    EXPECT_LT(all.back().header.stamp, stamp(0) + 600 * RosTime{1'000'000'000});
}

TEST_F(RobotPublisherTest, NothingIsPublishedBeforeTheFirstCorrection) {
    start_publishing();
    for (int n = 1; n < 4; ++n) { // some turns of the thread
        send_scan(robot_, n - 1);
        send_pose(robot_, n);
        next_x();
    }
    EXPECT_TRUE(transforms().empty());
    source_->correct(Pose2{});
    run_until([&] { return !transforms().empty(); });
}

TEST_F(RobotPublisherTest, AfterAReconnectItIsAnnouncedAgainInTheEncodingOfTheBridge) {
    start_publishing();
    source_->correct(Pose2{1.0, 2.0, 0.5});
    run_until([&] { return !transforms().empty(); });
    bridge_.reset();
    start_bridge(at(port_, R"({"op":"serverInfo","name":"","capabilities":["clientPublish"],)"
                           R"("supportedEncodings":["cdr"]})"));
    run_until([&] { return !transforms().empty(); });
    EXPECT_EQ(bridge_->published().front().encoding, "cdr");
    EXPECT_EQ(bridge_->published().front().type, "tf2_msgs/msg/TFMessage");
}

TEST_F(RobotPublisherTest, ABridgeThatLetsNoClientPublishIsAnError) {
    start_bridge(at(0, R"({"op":"serverInfo","name":"","capabilities":[]})"));
    robot_ = advertise_robot();
    auto stated = options();
    stated.publish.transform = true;
    make_source(std::move(stated));
    const auto poses = prepare(robot_);
    ASSERT_FALSE(poses);
    EXPECT_EQ(poses.error().code, Errc::kConflict);
    EXPECT_THAT(poses.error().message, HasSubstr("--publish-tf: the bridge does not let clients publish"));
}

TEST_F(RobotPublisherTest, ABridgeThatDoesNotAnyMoreIsNoted) {
    start_publishing();
    bridge_.reset();
    start_bridge(at(port_, R"({"op":"serverInfo","name":"","capabilities":[]})"));
    run_until([&] { return has_note("nothing is published: the bridge does not let clients publish"); });
}

TEST_F(RobotPublisherTest, WithoutOdometryTheTransformCannotBePublished) {
    start_bridge();
    const auto scan = bridge_->advertise("/scan", "ros1", "sensor_msgs/LaserScan");
    auto stated = options();
    stated.publish.transform = true;
    make_source(std::move(stated));
    const auto poses = prepare([&] {
        if (!bridge_->is_subscribed(scan)) return;
        bridge_->on_change = [] {};
        send_scan({.scan = scan}, 0);
    });
    ASSERT_FALSE(poses);
    EXPECT_THAT(poses.error().message, HasSubstr("--publish-tf needs odometry, but the robot's poses are: none"));
}

TEST_F(RobotPublisherTest, ASecondPublisherOfTheTransformIsRefused) {
    start_bridge();
    robot_ = advertise_robot();
    auto stated = options();
    stated.scans.robot.poses = Poses::kOdometry;
    stated.publish.transform = true;
    make_source(std::move(stated));
    const auto poses = prepare([&] {
        if (!bridge_->is_subscribed(robot_.scan) || !bridge_->is_subscribed(robot_.tf_static)) return;
        bridge_->on_change = [] {};
        send_static(robot_);
        const auto correction = testing_support::flat(stamp(0), "map", "odom", 1.0);
        bridge_->send(robot_.tf, stamp(0), testing_support::transform_bytes({correction}));
        send_pose(robot_, 0);
        send_scan(robot_, 0);
    });
    ASSERT_FALSE(poses);
    EXPECT_THAT(poses.error().message, HasSubstr("--publish-tf: another program publishes map -> odom"));
}

class PublishedMapTest : public RobotPublisherTest {
protected:
    void begin_map(const std::string& token = "") {
        start_bridge();
        robot_ = advertise_robot();
        auto stated = options();
        stated.publish.map = MapPlace{server_.place(token), "lab"};
        make_source(std::move(stated));
        const auto poses = prepare(robot_);
        ASSERT_TRUE(poses) << poses.error().message;
    }

    /// Sets the map of the server. @param revision  makes the entity tags
    void set_map(int revision, double origin, std::string cells) {
        const auto etag = fmt::format("\"{}\"", revision);
        server_.answers["map.yaml"] = {200, etag,
                                       fmt::format("image: map.pgm\nresolution: 0.1\norigin: [{}, 4, 0]\nnegate: 0\n"
                                                   "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                                                   origin)};
        server_.answers["map.pgm"] = {200, etag, fmt::format("P5\n{} 1\n255\n", cells.size()) + cells};
    }

    [[nodiscard]] std::size_t maps() const { return bridge_->published().size(); }

    FakeMapServer server_{io_};
};

TEST_F(PublishedMapTest, IsPublishedWhenItHasChanged) {
    begin_map("secret");
    run_until([&] { return server_.requests.size() >= 2; });
    EXPECT_EQ(server_.requests.front(), "/api/v1/sessions/lab/map.yaml");
    EXPECT_EQ(server_.authorization, "Bearer secret");
    set_map(1, -3.0, std::string("\xfe\x00\xcd", 3));
    run_until([&] { return maps() > 0; });
    const auto& first = bridge_->published().front();
    EXPECT_EQ(first.topic, "/map");
    EXPECT_EQ(first.type, "nav_msgs/OccupancyGrid");
    EXPECT_TRUE(first.payload.ends_with(std::string("\x00\x64\xff", 3)));
    const auto before = server_.requests.size();
    run_until([&] { return server_.requests.size() >= before + 3; });
    EXPECT_EQ(server_.requests.back(), "/api/v1/sessions/lab/map.yaml if changed");
    EXPECT_EQ(maps(), 1U);
    set_map(2, -3.0, std::string("\xfe\xfe\xfe", 3));
    run_until([&] { return maps() > 1; });
    EXPECT_TRUE(bridge_->published().back().payload.ends_with(std::string(3, '\0')));
}

TEST_F(PublishedMapTest, AMapThatMovesDuringItsDownloadIsDownloadedAgain) {
    begin_map();
    set_map(1, -3.0, "\xfe");
    server_.on_request = [&] {
        if (server_.requests.back().find("map.pgm") == std::string::npos) return;
        server_.on_request = [] {};
        set_map(2, -7.0, "\xfe\xfe"); // after map.yaml of revision 1
    };
    run_until([&] { return maps() > 0; });
    const auto origin = std::bit_cast<std::array<char, sizeof(double)>>(-7.0);
    EXPECT_THAT(bridge_->published().front().payload, HasSubstr(std::string(origin.data(), origin.size())));
}

TEST_F(PublishedMapTest, AnUnchangedMapIsRepeated) {
    start_bridge();
    robot_ = advertise_robot();
    auto stated = options();
    stated.publish.map = MapPlace{server_.place(), "lab"};
    stated.publish.map_repeated = 1ms;
    make_source(std::move(stated));
    ASSERT_TRUE(prepare(robot_));
    set_map(1, -3.0, "\xfe");
    run_until([&] { return maps() >= 3; });
}

TEST_F(PublishedMapTest, ProblemsAreNotedOnce) {
    begin_map();
    server_.answers["map.yaml"] = {403, "", ""};
    run_until([&] { return server_.requests.size() >= 10; });
    EXPECT_EQ(std::ranges::count_if(notes_, [](const auto& note) { return note.starts_with("the map cannot"); }), 1);
    EXPECT_TRUE(has_note("is answered with 403; name the file with the token of a viewer: --http-token-file"));
    EXPECT_EQ(maps(), 0U);
}

} // namespace
} // namespace scanloom::robot

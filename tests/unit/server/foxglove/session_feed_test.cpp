#include "server/foxglove/session_feed.hpp"

#include "robot_client/ros/messages.hpp"
#include "tests/support/random_map.hpp"

#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstring>

namespace scanloom::foxglove {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A viewer that connects to a session of one robot, whose state the test changes.
class SessionFeedTest : public testing::Test {
protected:
    SessionFeedTest() {
        testing_support::HandMadeMap map;
        map.set({0, 0}, 2000);
        maps_ = map.snapshot();
        mapping::RobotState robot;
        robot.name = "crawler";
        maps_.robots.push_back(robot);
        drive(1.0);
        topics_ = greeted();
    }

    /// The robot takes a scan 1 m further on.
    void drive(double stamp) {
        mapping::RobotState& robot = maps_.robots.front();
        robot.pose = Pose2{stamp, 0.0, 0.0};
        robot.stamp = stamp;
        ++robot.scan_count;
        ++maps_.revision;
        auto sensor = std::make_shared<Sensor>();
        sensor->angles = UniformAngles{-0.5, 0.5, 3};
        sensor->range_max = 8.0;
        Scan scan;
        scan.stamp = stamp;
        scan.pose = robot.pose;
        scan.ranges = {1000, 2000, 3000};
        robot.newest_scans = {std::make_shared<const mapping::IntegratedScan>(
            mapping::IntegratedScan{maps_.revision, std::move(sensor), std::move(scan)})};
    }

    std::vector<Outgoing> next(SessionFeed::Clock::duration after = 0ms) {
        SessionView view;
        view.maps = std::make_shared<const mapping::Snapshot>(maps_);
        view.connected = {is_connected_};
        view.guided = guided_;
        view.guided_version = guided_version_;
        view.map = std::make_shared<const std::string>("grid");
        view.is_map_too_large = is_map_too_large_;
        view.parts_revision = maps_.revision;
        return feed_.next(view, start_ + after);
    }

    /// Connects, and returns the announced topics in the order of their ids, which begin at 1.
    std::vector<std::string> greeted() {
        const auto messages = next();
        EXPECT_EQ(messages.size(), 2U);
        EXPECT_EQ(boost::json::parse(messages.at(0).bytes).at("op"), "serverInfo");
        std::vector<std::string> topics;
        const auto announced = boost::json::parse(messages.at(1).bytes);
        for (const auto& channel : announced.at("channels").as_array()) {
            topics.emplace_back(channel.at("topic").as_string());
            EXPECT_EQ(channel.at("id"), topics.size());
        }
        return topics;
    }

    /// Subscribes to a topic.
    /// @param id  of the subscription
    void subscribe(const std::string& topic, std::uint32_t id) {
        const auto at = std::ranges::find(topics_, topic);
        ASSERT_NE(at, topics_.end()) << topic;
        request(fmt::format(R"({{"op":"subscribe","subscriptions":[{{"id":{},"channelId":{}}}]}})", id,
                            at - topics_.begin() + 1));
    }

    void request(const std::string& text) { feed_.receive(text, true); }

    /// Returns the subscriptions of messages.
    static std::vector<std::uint32_t> ids_of(const std::vector<Outgoing>& messages) {
        std::vector<std::uint32_t> ids;
        for (const auto& message : messages) {
            EXPECT_FALSE(message.is_text) << message.bytes;
            ids.push_back(0);
            std::memcpy(&ids.back(), message.bytes.data() + 1, sizeof ids.back());
        }
        return ids;
    }

    mapping::Snapshot maps_;
    std::vector<Guided> guided_;
    std::uint64_t guided_version_ = 0;
    bool is_map_too_large_ = false;
    bool is_connected_ = true;
    SessionFeed feed_{"lab", "1-1"};
    const SessionFeed::Clock::time_point start_{1h};
    std::vector<std::string> topics_; // by their ids, which begin at 1
};

TEST_F(SessionFeedTest, GreetsAndAnnouncesTopics) {
    EXPECT_THAT(topics_, ElementsAre("/map", "/tf", "/diagnostics", "/landmarks", "/frontiers", "/goals", "/pose_graph",
                                     "/crawler/pose", "/crawler/trail", "/crawler/path", "/crawler/scan"));
    EXPECT_THAT(next(), IsEmpty()) << "nothing is subscribed";
}

TEST_F(SessionFeedTest, SendsWhatHasChanged) {
    subscribe("/tf", 7);
    subscribe("/crawler/scan", 8);
    const auto first = next();
    EXPECT_THAT(ids_of(first), ElementsAre(7U, 8U));
    std::size_t left_out = 0;
    const auto transforms = robot::decode_transforms(*first[0].rest, robot::MessageEncoding::kCdr, left_out);
    EXPECT_EQ(transforms.value().front().child, "crawler/base_link");
    EXPECT_EQ(transforms.value().front().T_parent_child.translation().x(), 1.0);
    const auto scan = robot::decode_laser_scan(*first[1].rest, robot::MessageEncoding::kCdr);
    EXPECT_THAT(scan.value().ranges, ElementsAre(1.0F, 2.0F, 3.0F));
    EXPECT_EQ(scan.value().header.frame, "crawler/sensor_0");

    EXPECT_THAT(next(10ms), IsEmpty());
    drive(2.0);
    drive(3.0);
    EXPECT_THAT(ids_of(next(20ms)), ElementsAre(7U, 8U)) << "the newest state only";
    request(R"({"op":"unsubscribe","subscriptionIds":[7]})");
    drive(4.0);
    EXPECT_THAT(ids_of(next(30ms)), ElementsAre(8U));
}

TEST_F(SessionFeedTest, TheMapComesOnceASecond) {
    subscribe("/map", 1);
    EXPECT_THAT(ids_of(next()), ElementsAre(1U));
    EXPECT_EQ(feed_.look_again(), SessionFeed::Clock::time_point::max());
    drive(2.0);
    EXPECT_THAT(next(400ms), IsEmpty());
    EXPECT_EQ(feed_.look_again(), start_ + 1s) << "although nothing else may change";
    EXPECT_THAT(ids_of(next(1s)), ElementsAre(1U));
}

TEST_F(SessionFeedTest, AnnouncesTopicsOfNewRobotsAndSensors) {
    mapping::RobotState second;
    second.name = "flyer";
    maps_.robots.push_back(second);
    auto messages = next();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_THAT(messages[0].bytes, HasSubstr(R"("id":12,"topic":"/flyer/pose")"));
    EXPECT_THAT(messages[0].bytes, testing::Not(HasSubstr("/map")));
    auto rear = *maps_.robots.front().newest_scans.front();
    auto sensor = *rear.sensor;
    sensor.id = 3;
    rear.sensor = std::make_shared<const Sensor>(sensor);
    maps_.robots.front().newest_scans.push_back(std::make_shared<const mapping::IntegratedScan>(rear));
    messages = next();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_THAT(messages[0].bytes, HasSubstr(R"("id":15,"topic":"/crawler/scan_3")"));
    subscribe("/crawler/scan", 1);
    request(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":15}]})");
    EXPECT_THAT(ids_of(next()), ElementsAre(1U, 2U)) << "the scans of both sensors";
}

TEST_F(SessionFeedTest, RemarksWhatViewersDoWrong) {
    subscribe("/tf", 7);
    subscribe("/tf", 8);
    subscribe("/map", 7);
    request(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":99},{"id":10,"channelId":0}]})");
    request(R"({"op":"unsubscribe","subscriptionIds":[70]})");
    request("nonsense");
    feed_.receive("\1", false);
    std::vector<std::string> remarks;
    for (const auto& message : next()) {
        if (!message.is_text) continue;
        const auto remark = boost::json::parse(message.bytes);
        EXPECT_EQ(remark.at("op"), "status");
        remarks.emplace_back(remark.at("message").as_string());
    }
    EXPECT_THAT(remarks, ElementsAre("the channel 2 is subscribed already", "the subscription 7 exists already",
                                     "there is no channel 99", "there is no channel 0", "there is no subscription 70",
                                     HasSubstr("not a JSON object"), HasSubstr("binary message")));
    EXPECT_THAT(next(), IsEmpty());
}

TEST_F(SessionFeedTest, WarningsOfOneTurnAreBounded) {
    std::string ids = "1";
    for (int n = 2; n < 10'000; ++n) ids += fmt::format(",{}", n);
    for (int n = 0; n < 3; ++n) request(fmt::format(R"({{"op":"unsubscribe","subscriptionIds":[{}]}})", ids));
    EXPECT_EQ(next().size(), SessionFeed::kWarningsMax);
    EXPECT_THAT(next(), IsEmpty());
}

TEST_F(SessionFeedTest, GoalsAndPathsFollowTheirRobots) {
    subscribe("/goals", 1);
    subscribe("/crawler/path", 2);
    EXPECT_THAT(ids_of(next()), ElementsAre(1U, 2U)) << "empty ones, so that viewers remove what they had";
    guided_ = {{0, Point2{4.0, 5.0}, {{1.0, 1.0}, {4.0, 5.0}}}};
    ++guided_version_;
    const auto messages = next(2s);
    ASSERT_THAT(ids_of(messages), ElementsAre(1U, 2U));
    EXPECT_THAT(*messages[0].rest, HasSubstr("crawler"));
    // Each pose is a header of 16 bytes and seven doubles at a multiple of 8; before them are 4 + 16 + 4 bytes.
    double second[2] = {};
    ASSERT_EQ(messages[1].rest->size(), 4U + 168);
    std::memcpy(second, messages[1].rest->data() + 4 + 112, sizeof second);
    EXPECT_THAT(second, ElementsAre(4.0, 5.0));
}

TEST_F(SessionFeedTest, SharesTheMapWithOtherViewers) {
    subscribe("/map", 1);
    const auto messages = next();
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(messages[0].bytes.size(), 13U);
    EXPECT_EQ(*messages[0].rest, "grid");
}

TEST_F(SessionFeedTest, WarnsOnceOfAMapThatIsTooLarge) {
    is_map_too_large_ = true;
    EXPECT_THAT(next(), IsEmpty()) << "the map is not subscribed";
    subscribe("/map", 1);
    EXPECT_THAT(next(1s).at(0).bytes, HasSubstr("the map is too large"));
    drive(2.0);
    for (const auto& message : next(3s)) EXPECT_FALSE(message.is_text);
}

TEST_F(SessionFeedTest, StatusFollowsConnections) {
    subscribe("/diagnostics", 1);
    EXPECT_THAT(*next().at(0).rest, testing::Not(HasSubstr("not connected")));
    is_connected_ = false;
    EXPECT_THAT(*next(2s).at(0).rest, HasSubstr("given, not connected"));
}

TEST_F(SessionFeedTest, ATrailIsThinnedAndEndsAtTheRobot) {
    mapping::Trajectory trajectory;
    for (Revision n = 1; n <= 2'050; ++n) trajectory.append({n, 0.0, {static_cast<double>(n), 0.0, 0.0}});
    maps_.robots.front().trajectory = trajectory.snapshot();
    subscribe("/crawler/trail", 1);
    std::uint32_t poses = 0;
    std::memcpy(&poses, next().at(0).rest->data() + 4 + 16, sizeof poses);
    EXPECT_EQ(poses, 1'026U) << "every second one, and the newest";
}

} // namespace
} // namespace scanloom::foxglove

#include "robot_client/foxglove/core/bridge_session.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace scanloom::robot::foxglove {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

constexpr const char* kInfo = R"({"op":"serverInfo","name":"b","capabilities":["clientPublish"],)"
                              R"("supportedEncodings":["json","ros1"]})";

std::string channel(std::uint64_t id, const std::string& topic, const std::string& encoding = "ros1",
                    const std::string& type = "sensor_msgs/LaserScan") {
    return fmt::format(R"({{"id":{},"topic":"{}","encoding":"{}","schemaName":"{}"}})", id, topic, encoding, type);
}

std::string advertise(const std::string& channels) {
    return fmt::format(R"({{"op":"advertise","channels":[{}]}})", channels);
}

std::string unadvertise(std::uint64_t id) { return fmt::format(R"({{"op":"unadvertise","channelIds":[{}]}})", id); }

/// A message of a subscription, at 5 ns.
std::string message(std::uint32_t subscription, const std::string& payload) {
    std::string bytes = encode_message(subscription, std::string("\5\0\0\0\0\0\0\0", 8));
    return bytes + payload;
}

class BridgeSessionTest : public testing::Test {
protected:
    BridgeSessionTest() {
        session_.begin();
        EXPECT_TRUE(std::holds_alternative<Connected>(session_.take_text(kInfo)));
    }

    void take(const std::string& text) { static_cast<void>(session_.take_text(text)); }

    /// Returns the frames to send.
    std::vector<std::string> sent() {
        std::vector<std::string> frames;
        while (auto frame = session_.next_frame()) frames.push_back(std::move(frame->bytes));
        return frames;
    }

    /// Returns "topic payload" of a message; "" if it is not delivered.
    std::string delivered(const std::string& bytes) {
        const auto event = session_.take_binary(bytes);
        const auto* one = std::get_if<Delivered>(&event);
        return one == nullptr ? "" : one->topic.name + " " + std::string(one->payload);
    }

    std::string needed_type_ = "sensor_msgs/LaserScan";
    BridgeSession session_{[this](const RecordedTopic& topic) { return topic.type == needed_type_; }};
};

TEST_F(BridgeSessionTest, NeededTopicsAreSubscribedToOnce) {
    take(advertise(channel(7, "/scan") + "," + channel(8, "/cmd", "ros1", "geometry_msgs/Twist") + "," +
                   channel(9, "/scan2", "cdr", "sensor_msgs/msg/LaserScan")));
    EXPECT_THAT(sent(), ElementsAre(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":7},)"
                                    R"({"id":2,"channelId":9}]})"));
    take(advertise(channel(7, "/scan")));
    EXPECT_THAT(sent(), IsEmpty());
    EXPECT_THAT(session_.refused(), IsEmpty());
}

TEST_F(BridgeSessionTest, MessagesAreDeliveredWithTheirTopic) {
    take(advertise(channel(7, "/scan", "cdr", "sensor_msgs/msg/LaserScan")));
    const auto bytes = message(1, "abc");
    const auto event = session_.take_binary(bytes);
    const auto& one = std::get<Delivered>(event);
    EXPECT_EQ(one.topic, (RecordedTopic{"/scan", "sensor_msgs/LaserScan", MessageEncoding::kCdr}));
    EXPECT_EQ(one.log_time, 5);
    EXPECT_EQ(one.payload, "abc");
}

TEST_F(BridgeSessionTest, ATopicThatComesBackIsSubscribedToUnderItsNewId) {
    take(advertise(channel(7, "/scan")));
    static_cast<void>(sent());
    take(unadvertise(7));
    EXPECT_THAT(sent(), IsEmpty());
    EXPECT_EQ(delivered(message(1, "late")), "");
    take(advertise(channel(12, "/scan")));
    EXPECT_THAT(sent(), ElementsAre(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":12}]})"));
    EXPECT_EQ(delivered(message(2, "new")), "/scan new");
    EXPECT_THAT(session_.refused(), IsEmpty()) << "a message on its way when a subscription ends is no fault";
}

TEST_F(BridgeSessionTest, ATopicOfSeveralChannelsIsSubscribedToOnceAndMovesToTheNext) {
    take(advertise(channel(7, "/scan") + "," + channel(8, "/scan")));
    EXPECT_THAT(sent(), ElementsAre(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":7}]})"));
    take(unadvertise(7));
    EXPECT_THAT(sent(), ElementsAre(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":8}]})"));
}

TEST_F(BridgeSessionTest, AnIdWithAnotherMeaningReplacesTheEarlierChannel) {
    take(advertise(channel(7, "/scan")));
    static_cast<void>(sent());
    take(advertise(channel(7, "/other")));
    EXPECT_THAT(sent(), ElementsAre(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":7}]})"));
    EXPECT_EQ(delivered(message(2, "x")), "/other x");
    EXPECT_EQ(delivered(message(1, "x")), "");
    EXPECT_THAT(session_.refused(), ElementsAre(Pair("an id of a channel that is in use", 1)));
}

TEST_F(BridgeSessionTest, HostileFramesAreCountedAndChangeNothing) {
    take(advertise(channel(7, "/scan")));
    static_cast<void>(sent());
    take("nonsense");
    take("nonsense");
    take(kInfo);
    take(unadvertise(99));
    take(advertise(R"({"id":"7"})"));
    EXPECT_EQ(delivered(message(0, "x")), "");
    EXPECT_EQ(delivered(message(4'000'000'000, "x")), "");
    EXPECT_EQ(delivered("\x01"), "");
    EXPECT_THAT(sent(), IsEmpty());
    EXPECT_EQ(delivered(message(1, "x")), "/scan x");
    EXPECT_THAT(session_.refused(),
                ElementsAre(Pair("a channel without id, topic, encoding or schema", 1),
                            Pair("a message of an unknown subscription", 2), Pair("a second serverInfo", 1),
                            Pair("a short message", 1), Pair("a text frame that is no JSON object", 2),
                            Pair("an unadvertise of an unknown channel", 1)));
}

TEST_F(BridgeSessionTest, ChannelsAndSubscriptionsAreBounded) {
    std::string channels = channel(0, "/scan0");
    for (std::uint64_t n = 1; n <= BridgeSession::kChannelsMax; ++n)
        channels += "," + channel(n, fmt::format("/scan{}", n));
    take(advertise(channels));
    EXPECT_EQ(session_.topics().size(), BridgeSession::kChannelsMax);
    EXPECT_THAT(session_.refused(),
                ElementsAre(Pair("a channel beyond 10,000", 1), Pair("a topic beyond 256 that are subscribed to", 1)));
    EXPECT_EQ(delivered(message(256, "x")).substr(0, 5), "/scan");
    EXPECT_EQ(delivered(message(257, "x")), "");
}

TEST_F(BridgeSessionTest, ChannelsThatComeAndGoLeaveNoFramesBehind) {
    for (int n = 0; n < 1000; ++n) {
        take(advertise(channel(7, "/scan")));
        take(unadvertise(7));
    }
    EXPECT_THAT(sent(), IsEmpty());
}

TEST_F(BridgeSessionTest, TopicsThatAreNotNeededAnyMoreAreUnsubscribed) {
    take(advertise(channel(7, "/scan") + "," + channel(8, "/odom", "ros1", "nav_msgs/Odometry")));
    static_cast<void>(sent());
    needed_type_ = "nav_msgs/Odometry";
    session_.update_subscriptions();
    EXPECT_THAT(sent(), ElementsAre(R"({"op":"unsubscribe","subscriptionIds":[1]})",
                                    R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":8}]})"));
    EXPECT_EQ(delivered(message(1, "late")), "");
    EXPECT_THAT(session_.refused(), IsEmpty());
}

TEST_F(BridgeSessionTest, ANewConnectionForgetsChannelsAndSubscribesAgain) {
    const auto publication = session_.add_publication("/tf", "tf2_msgs/TFMessage");
    take(advertise(channel(7, "/scan")));
    static_cast<void>(sent());
    session_.publish(publication, "unsent");
    session_.begin();
    EXPECT_FALSE(session_.is_connected());
    EXPECT_EQ(delivered(message(1, "x")), "");
    EXPECT_THAT(sent(), IsEmpty());
    take(kInfo);
    take(advertise(channel(3, "/scan")));
    EXPECT_THAT(sent(), ElementsAre(R"({"op":"subscribe","subscriptions":[{"id":2,"channelId":3}]})",
                                    HasSubstr(R"("topic":"/tf")")));
}

TEST_F(BridgeSessionTest, MessagesArePublishedInTheEncodingOfTheBridge) {
    const auto publication = session_.add_publication("/tf", "tf2_msgs/TFMessage");
    EXPECT_EQ(session_.publish_encoding(), MessageEncoding::kRos1);
    EXPECT_EQ(session_.publish_problem(), "");
    session_.publish(publication, "a");
    session_.publish(publication, "b");
    EXPECT_THAT(sent(), ElementsAre(encode_advertise({0, "/tf", "ros1", "tf2_msgs/TFMessage"}), encode_message(0, "b")))
        << "an unsent message is replaced by a newer one";

    session_.begin();
    take(R"({"op":"serverInfo","name":"","capabilities":["clientPublish"],"supportedEncodings":["cdr"]})");
    EXPECT_THAT(sent(), ElementsAre(encode_advertise({0, "/tf", "cdr", "tf2_msgs/msg/TFMessage"})));
}

TEST_F(BridgeSessionTest, PublicationsTakeTurns) {
    const auto map = session_.add_publication("/map", "nav_msgs/OccupancyGrid");
    const auto tf = session_.add_publication("/tf", "tf2_msgs/TFMessage");
    static_cast<void>(sent());
    for (int n = 0; n < 2; ++n) {
        session_.publish(map, "m");
        session_.publish(tf, "t");
        EXPECT_EQ(sent().size(), 2U);
    }
    session_.publish(map, "m");
    session_.publish(tf, "t");
    const auto first = session_.next_frame()->bytes;
    session_.publish(map, "m");
    session_.publish(tf, "t");
    EXPECT_NE(session_.next_frame()->bytes, first);
}

TEST_F(BridgeSessionTest, ABridgeThatTakesNoMessagesIsExplained) {
    const auto publication = session_.add_publication("/tf", "tf2_msgs/TFMessage");
    const std::pair<const char*, const char*> cases[] = {
        {R"({"op":"serverInfo","name":"","capabilities":["time"]})", "does not let clients publish"},
        {R"({"op":"serverInfo","name":"","capabilities":["clientPublish"]})", "it takes: none"},
        {R"({"op":"serverInfo","name":"","capabilities":["clientPublish"],"supportedEncodings":["json"]})",
         "it takes: json"},
    };
    for (const auto& [info, problem] : cases) {
        session_.begin();
        take(info);
        EXPECT_EQ(session_.publish_encoding(), std::nullopt);
        EXPECT_THAT(session_.publish_problem(), HasSubstr(problem));
        session_.publish(publication, "a");
        EXPECT_THAT(sent(), IsEmpty());
    }
}

} // namespace
} // namespace scanloom::robot::foxglove

#include "server/foxglove/protocol.hpp"

#include <boost/json/parse.hpp>
#include <fmt/format.h>
#include <gmock/gmock.h>

namespace scanloom::foxglove {
namespace {

using testing::HasSubstr;

std::string hex(std::string_view bytes) {
    std::string text;
    for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    return text;
}

/// The bytes are those of Foxglove's own tests.
TEST(FoxgloveProtocol, DataHaveTheBytesOfTheSpecification) {
    EXPECT_EQ(hex(data_head(30, 1234)), "011e000000d204000000000000") << R"({"key": "value"} follows)";
}

TEST(FoxgloveProtocol, ReadsSubscriptions) {
    const auto subscribe = decode_request(
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5}]})");
    const auto& subscriptions = std::get<Subscribe>(*subscribe).subscriptions;
    ASSERT_EQ(subscriptions.size(), 2U);
    EXPECT_EQ(subscriptions[0].id, 0U);
    EXPECT_EQ(subscriptions[0].channel, 3U);
    EXPECT_EQ(subscriptions[1].id, 4294967295U);
    const auto unsubscribe = decode_request(R"({"op":"unsubscribe","subscriptionIds":[0,7]})");
    EXPECT_THAT(std::get<Unsubscribe>(*unsubscribe).ids, testing::ElementsAre(0U, 7U));
}

TEST(FoxgloveProtocol, RefusesWhatIsNoRequest) {
    const std::string deep = std::string(100'000, '[');
    for (const std::string& text :
         {std::string(), std::string("{"), std::string("[]"), std::string("{}"), std::string(R"({"op":7})"),
          std::string(R"({"op":"subscribe"})"), std::string(R"({"op":"subscribe","subscriptions":{}})"),
          std::string(R"({"op":"subscribe","subscriptions":[7]})"),
          std::string(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"),
          std::string(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":4294967296}]})"),
          std::string(R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})"),
          std::string(R"({"op":"unsubscribe","subscriptionIds":["1"]})"), deep}) {
        const auto read = decode_request(text);
        ASSERT_FALSE(read) << text.substr(0, 80);
        EXPECT_EQ(read.error().code, Errc::kMalformed);
    }
    const auto other = decode_request(R"({"op":"setParameters"})");
    EXPECT_EQ(other.error().code, Errc::kUnsupportedVersion);
    EXPECT_THAT(other.error().message, HasSubstr("setParameters is not possible"));
    const auto cut = decode_request("{\"op\":\"" + std::string(39, 'a') + "\u00e9\"}");
    EXPECT_THAT(cut.error().message, HasSubstr("an op with a long name")) << "not cut within a character";
}

/// Decodes what viewers decode: the schemas of ROS are text, those of Protocol Buffers are base64.
TEST(FoxgloveProtocol, AdvertisesSchemas) {
    const std::vector<Advertised> channels{{1, "/map", Message::kGrid}, {2, "/goals", Message::kScene}};
    const auto text = boost::json::parse(advertise_text(channels));
    EXPECT_EQ(text.at("op"), "advertise");
    const auto& map = text.at("channels").at(0);
    EXPECT_EQ(map.at("id"), 1);
    EXPECT_EQ(map.at("topic"), "/map");
    EXPECT_EQ(map.at("encoding"), "cdr");
    EXPECT_EQ(map.at("schemaName"), "nav_msgs/msg/OccupancyGrid");
    EXPECT_EQ(map.at("schemaEncoding"), "ros2msg");
    EXPECT_THAT(std::string(map.at("schema").as_string()), HasSubstr("MSG: geometry_msgs/Quaternion\nfloat64 x\n"));
    const auto& goals = text.at("channels").at(1);
    EXPECT_EQ(goals.at("encoding"), "protobuf");
    EXPECT_EQ(goals.at("schemaName"), "foxglove.SceneUpdate");
    EXPECT_EQ(goals.at("schemaEncoding"), "protobuf");
    const std::string schema(goals.at("schema").as_string());
    EXPECT_TRUE(schema.starts_with("C")) << "field 1 of a FileDescriptorSet, in base64";
    EXPECT_EQ(schema.size() % 4, 0U);
}

} // namespace
} // namespace scanloom::foxglove

#include "robot_client/foxglove/core/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace scanloom::robot::foxglove {
namespace {

using testing::ElementsAre;

/// Returns the bytes of their hexadecimal digits.
std::string bytes_of(std::string_view digits) {
    std::string bytes;
    for (std::size_t n = 0; n + 1 < digits.size(); n += 2) {
        bytes += static_cast<char>(std::stoi(std::string(digits.substr(n, 2)), nullptr, 16));
    }
    return bytes;
}

std::string refused_text(std::string_view text) {
    const auto frame = decode_text(text);
    return frame ? "accepted" : frame.error().message;
}

template <class Kind>
Kind decoded(std::string_view text) {
    const auto frame = decode_text(text);
    if (!frame) ADD_FAILURE() << frame.error().message;
    const auto* kind = frame ? std::get_if<Kind>(&*frame) : nullptr;
    if (kind == nullptr) ADD_FAILURE() << text << " is of another kind";
    return kind == nullptr ? Kind() : *kind;
}

TEST(FoxgloveProtocol, MessageDataIsThatOfTheSdksSnapshot) {
    const auto bytes = bytes_of("011e000000d2040000000000007b226b6579223a202276616c7565227d");
    const auto frame = decode_binary(bytes);
    ASSERT_TRUE(frame);
    const auto& message = std::get<MessageData>(*frame);
    EXPECT_EQ(message.subscription, 30U);
    EXPECT_EQ(message.log_time, 1234U);
    EXPECT_EQ(message.payload, R"({"key": "value"})");
}

TEST(FoxgloveProtocol, ClientMessageIsThatOfTheSdksSnapshot) {
    EXPECT_EQ(encode_message(30, R"({"key": "value"})"), bytes_of("011e0000007b226b6579223a202276616c7565227d"));
}

TEST(FoxgloveProtocol, BinaryFramesAreDecodedByTheirOpcode) {
    const auto time = decode_binary(bytes_of("02d204000000000000"));
    ASSERT_TRUE(time);
    EXPECT_EQ(std::get<ServerTime>(*time).nanoseconds, 1234U);
    for (const char* unneeded : {"040a000000000000000064617461", "040a0000000105000000", "030a000000", "05"}) {
        const auto frame = decode_binary(bytes_of(unneeded));
        ASSERT_TRUE(frame) << unneeded;
        EXPECT_TRUE(std::holds_alternative<Unneeded>(*frame)) << unneeded;
    }
}

TEST(FoxgloveProtocol, ShortAndUnknownBinaryFramesAreRefused) {
    const std::pair<const char*, const char*> cases[] = {
        {"", "an empty binary frame"},
        {"01", "a short message"},
        {"011e000000d20400000000", "a short message"},
        {"02d2040000000000", "a short time"},
        {"06", "a binary frame with an opcode that is not known"},
        {"ff1e000000d204000000000000", "a binary frame with an opcode that is not known"},
    };
    for (const auto& [bytes, reason] : cases) {
        const auto frame = decode_binary(bytes_of(bytes));
        ASSERT_FALSE(frame) << bytes;
        EXPECT_EQ(frame.error().message, reason);
    }
    EXPECT_TRUE(decode_binary(bytes_of("011e000000d204000000000000"))) << "an empty payload";
}

TEST(FoxgloveProtocol, ServerInfoHasCapabilitiesAndEncodings) {
    const auto info = decoded<ServerInfo>(R"({"op":"serverInfo","name":"b","capabilities":["clientPublish","time"],)"
                                          R"("supportedEncodings":["cdr"],"metadata":{"a":"b"},"sessionId":"1"})");
    EXPECT_EQ(info.name, "b");
    EXPECT_THAT(info.capabilities, ElementsAre("clientPublish", "time"));
    EXPECT_THAT(info.supported_encodings, ElementsAre("cdr"));
    EXPECT_TRUE(decoded<ServerInfo>(R"({"op":"serverInfo","name":"","capabilities":[]})").supported_encodings.empty());
}

TEST(FoxgloveProtocol, AdvertiseHasItsValidChannels) {
    const auto advertise = decoded<Advertise>(R"({"op":"advertise","channels":[
        {"id":1,"topic":"/scan","encoding":"ros1","schemaName":"sensor_msgs/LaserScan","schema":""},
        {"id":4294967295,"topic":"/tf","encoding":"cdr","schemaName":"tf2_msgs/msg/TFMessage","schemaEncoding":null},
        {"id":3.0,"topic":"/c","encoding":"json","schemaName":""},
        {"id":-1,"topic":"/a","encoding":"cdr","schemaName":""},
        {"id":1.5,"topic":"/a","encoding":"cdr","schemaName":""},
        {"id":"1","topic":"/a","encoding":"cdr","schemaName":""}, {"id":2,"topic":7,"encoding":"cdr","schemaName":""},
        {"id":2,"topic":"","encoding":"cdr","schemaName":""}, {"id":2,"topic":"/a","schemaName":""}, [], null,
        {"id":1e300,"topic":"/a","encoding":"cdr","schemaName":""}]})");
    EXPECT_THAT(advertise.channels,
                ElementsAre(Channel{1, "/scan", "ros1", "sensor_msgs/LaserScan"},
                            Channel{4294967295, "/tf", "cdr", "tf2_msgs/msg/TFMessage"}, Channel{3, "/c", "json", ""}));
    EXPECT_EQ(advertise.refused, 9U);
    EXPECT_TRUE(decoded<Advertise>(R"({"op":"advertise","channels":[]})").channels.empty());
}

TEST(FoxgloveProtocol, OtherTextFramesAreDecodedByTheirOp) {
    EXPECT_THAT(decoded<Unadvertise>(R"({"op":"unadvertise","channelIds":[3,1]})").ids, ElementsAre(3U, 1U));
    const auto status = decoded<Status>(R"({"op":"status","level":2,"message":"no","id":"x"})");
    EXPECT_EQ(status.level, Status::Level::kError);
    EXPECT_EQ(status.message, "no");
    for (const char* op : {"removeStatus", "parameterValues", "advertiseServices", "unadvertiseServices",
                           "connectionGraphUpdate", "serviceCallFailure"}) {
        static_cast<void>(decoded<Unneeded>(std::string(R"({"op":")") + op + R"("})"));
    }
}

TEST(FoxgloveProtocol, HostileTextFramesAreRefusedWithAReason) {
    const std::pair<std::string, const char*> cases[] = {
        {"", "a text frame that is no JSON object"},
        {"{", "a text frame that is no JSON object"},
        {"[1,2]", "a text frame that is no JSON object"},
        {R"({"op":"status"} {})", "a text frame that is no JSON object"},
        {std::string(100'000, '['), "a text frame that is no JSON object"},
        {R"({"op":"advertise","channels":)" + std::string(20, '[') + std::string(20, ']') + "}",
         "a text frame that is no JSON object"},
        {R"({"op":"a","x":")" + std::string(kTextBytesMax, ' ') + R"("})", "a text frame of more than 8 MiB"},
        {"{}", "a text frame without op"},
        {R"({"op":7})", "a text frame without op"},
        {R"({"op":"login"})", "a text frame with an op that is not known"},
        {R"({"op":"serverInfo","capabilities":[]})", "a serverInfo without name, capabilities or encodings"},
        {R"({"op":"serverInfo","name":"","capabilities":{}})", "a serverInfo without name, capabilities or encodings"},
        {R"({"op":"serverInfo","name":"","capabilities":[1]})", "a serverInfo without name, capabilities or encodings"},
        {R"({"op":"advertise"})", "an advertise without channels"},
        {R"({"op":"advertise","channels":{}})", "an advertise without channels"},
        {R"({"op":"unadvertise","channelIds":7})", "an unadvertise without channelIds"},
        {R"({"op":"unadvertise","channelIds":["7"]})", "an unadvertise with an id that is none"},
        {R"({"op":"status","level":3,"message":""})", "a status without level or message"},
        {R"({"op":"status","level":"1","message":""})", "a status without level or message"},
    };
    for (const auto& [text, reason] : cases) EXPECT_EQ(refused_text(text), reason) << text.substr(0, 100);
}

TEST(FoxgloveProtocol, FramesOfClientsAreJson) {
    EXPECT_EQ(encode_subscribe({{1, 30}, {2, 4294967295}}),
              R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":30},{"id":2,"channelId":4294967295}]})");
    EXPECT_EQ(encode_unsubscribe({1, 2}), R"({"op":"unsubscribe","subscriptionIds":[1,2]})");
    EXPECT_EQ(encode_advertise({0, "/tf", "ros1", "tf2_msgs/TFMessage"}),
              R"({"op":"advertise","channels":[{"id":0,"topic":"/tf","encoding":"ros1",)"
              R"("schemaName":"tf2_msgs/TFMessage"}]})");
}

} // namespace
} // namespace scanloom::robot::foxglove

#include "robot_client/foxglove/url.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

TEST(BridgeUrl, HasSchemeAddressAndTarget) {
    struct Case {
        const char* text;
        bool is_encrypted;
        const char* address;
        const char* target;
    };
    const Case cases[] = {
        {"ws://robot:8765", false, "robot:8765", "/"},
        {"ws://robot", false, "robot:8765", "/"},
        {"wss://10.0.0.7:443/bridge?token=a", true, "10.0.0.7:443", "/bridge?token=a"},
        {"ws://[::1]:9000/", false, "[::1]:9000", "/"},
        {"ws://[fe80::1]", false, "[fe80::1]:8765", "/"},
        {"ws://robot?token=a#part", false, "robot:8765", "/?token=a"},
    };
    for (const auto& one : cases) {
        const auto url = parse_url(one.text, kWebSocketUrl);
        ASSERT_TRUE(url) << one.text;
        EXPECT_EQ(url->is_encrypted, one.is_encrypted) << one.text;
        EXPECT_EQ(url->address.text(), one.address);
        EXPECT_EQ(url->target, one.target);
        EXPECT_EQ(url->text, one.text);
    }
    EXPECT_EQ(parse_url("http://maps.lab", kHttpUrl)->address.text(), "maps.lab:8080");
}

TEST(BridgeUrl, OtherTextsAreRefused) {
    for (const char* text :
         {"", "ws://", "robot:8765", "http://robot:8765", "ws:/robot", "ws://:8765", "ws://robot:0", "ws://robot:70000",
          "ws://robot:x", "ws://a b", "ws://me@robot", "ws://::1:80", "ws://robot/\r\nHost: x", "WS://robot"}) {
        const auto url = parse_url(text, kWebSocketUrl);
        ASSERT_FALSE(url) << text;
        EXPECT_THAT(url.error().message, testing::HasSubstr("is not ws://HOST:PORT or wss://HOST:PORT"));
    }
}

} // namespace
} // namespace scanloom::robot

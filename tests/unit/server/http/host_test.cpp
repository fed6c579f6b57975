#include "server/http/header_fields.hpp"

#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

TEST(KnownHost, AddressesAndLocalhostAreKnown) {
    for (const auto* host :
         {"127.0.0.1", "127.0.0.1:8080", "localhost", "LocalHost:8080", "[::1]", "[::1]:8080", "10.0.0.7"}) {
        EXPECT_TRUE(is_known_host(host, {})) << host;
    }
}

TEST(KnownHost, OtherNamesAreUnknown) {
    for (const auto* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example:8080", "user@localhost",
                             "", ":80", "local host", "127.0.0.1:x"}) {
        EXPECT_FALSE(is_known_host(host, {})) << host;
    }
}

TEST(KnownHost, ConfiguredNamesAreKnown) {
    EXPECT_TRUE(is_known_host("Maps.example:80", {"robots.example", "maps.example"}));
    EXPECT_FALSE(is_known_host("xmaps.example", {"maps.example"}));
}

TEST(OwnPage, HasTheHostAndPortOfTheRequest) {
    EXPECT_TRUE(is_own_page("http://10.0.0.7:8080", "10.0.0.7:8080", false));
    EXPECT_TRUE(is_own_page("http://LOCALHOST:8080", "localhost:8080", false));
    EXPECT_TRUE(is_own_page("http://[::1]:8080", "[::1]:8080", false));
    EXPECT_TRUE(is_own_page("https://Maps.example", "maps.example", false)) << "a proxy adds TLS";
    EXPECT_TRUE(is_own_page("https://maps.example", "maps.example:443", false));
    EXPECT_TRUE(is_own_page("http://maps.example:80", "maps.example", false));
}

TEST(OwnPage, RejectsAnotherPortOfTheSameHost) {
    for (const auto* origin : {"http://localhost:5173", "http://localhost", "http://127.0.0.1:8080",
                               "http://[::1]:8080", "https://localhost"}) {
        EXPECT_FALSE(is_own_page(origin, "localhost:8080", false)) << origin;
    }
    EXPECT_FALSE(is_own_page("https://maps.example:8443", "maps.example", false));
}

TEST(OwnPage, RejectsForeignHosts) {
    for (const auto* origin :
         {"http://evil.example", "http://maps.example.evil.example", "http://localhost.evil.example", "null", "",
          "maps.example", "file://", "http://", "http://:80", "ftp://maps.example:8080",
          "http://evil@maps.example:8080", "chrome-extension://maps.example:8080", "http://10.0.0.7",
          "http://maps.example http://evil.example"}) {
        EXPECT_FALSE(is_own_page(origin, "maps.example:8080", false)) << origin;
    }
}

TEST(OwnPage, RejectsHttpOriginsOverTls) {
    EXPECT_TRUE(is_own_page("https://maps.example", "maps.example", true));
    EXPECT_FALSE(is_own_page("http://maps.example", "maps.example", true))
        << "an attacker on the network may have sent it";
}

TEST(WebSocketKey, IsSixteenBytesInBase64) {
    EXPECT_TRUE(is_websocket_key("dGhlIHNhbXBsZSBub25jZQ==")); // the example of RFC 6455
    for (const auto* key : {"", "dGhlIHNhbXBsZSBub25jZQ", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25j Q==",
                            "dGhlIHNhbXBsZSBub25jZQA==", "========================"}) {
        EXPECT_FALSE(is_websocket_key(key)) << key;
    }
}

} // namespace
} // namespace scanloom::http

#include "server/http/host.hpp"

#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

TEST(KnownHost, AddressesAndLocalhostAreKnown) {
    for (const auto* host :
         {"127.0.0.1", "127.0.0.1:8080", "localhost", "LocalHost:8080", "[::1]", "[::1]:8080", "10.0.0.7"}) {
        EXPECT_TRUE(is_known_host(host, {})) << host;
    }
}

TEST(KnownHost, NamesOfStrangersAreNot) {
    for (const auto* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example:8080", "user@localhost",
                             "", ":80", "local host", "127.0.0.1:x"}) {
        EXPECT_FALSE(is_known_host(host, {})) << host;
    }
}

TEST(KnownHost, ConfiguredNamesAreKnown) {
    EXPECT_TRUE(is_known_host("Maps.example:80", {"robots.example", "maps.example"}));
    EXPECT_FALSE(is_known_host("xmaps.example", {"maps.example"}));
}

} // namespace
} // namespace scanloom::http

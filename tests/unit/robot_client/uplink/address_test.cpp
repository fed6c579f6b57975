#include "common/net/connect.hpp"
#include "common/net/server_list.hpp"

#include <gtest/gtest.h>

namespace scanloom::net {
namespace {

TEST(Address, AcceptsNamesAndAddresses) {
    EXPECT_EQ(parse_address("pi.local:4001")->host, "pi.local");
    EXPECT_EQ(parse_address("pi.local:4001")->port, "4001");
    EXPECT_EQ(parse_address("[::1]:1")->host, "::1");
    for (const auto* wrong : {"", "pi", "pi:", ":1", "::1:1", "pi:0", "pi:65536", "pi:x", "pi:1x", "pi:-1", "[]:1x"}) {
        EXPECT_FALSE(parse_address(wrong)) << wrong;
    }
}

TEST(Address, TextCanBeParsedAgain) {
    for (const auto* text : {"pi.local:4001", "[::1]:1"}) EXPECT_EQ(parse_address(text)->text(), text);
}

TEST(Address, ListsMayHaveSpacesButNoGaps) {
    EXPECT_EQ(text_of(parse_addresses("a:1,b:2, c:3 ").value()), "a:1,b:2,c:3");
    for (const auto* wrong : {"", " ", "a:1,", ",a:1", "a:1,,b:2", "a:1 b:2"}) {
        EXPECT_FALSE(parse_addresses(wrong)) << wrong;
    }
}

} // namespace
} // namespace scanloom::net

#include "robot_client/uplink/server_address.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

TEST(ServerAddress, AcceptsNamesAndAddresses) {
    EXPECT_EQ(parse_server_address("pi.local:4001")->host, "pi.local");
    EXPECT_EQ(parse_server_address("pi.local:4001")->port, "4001");
    EXPECT_EQ(parse_server_address("[::1]:1")->host, "::1");
    for (const auto* wrong : {"", "pi", "pi:", ":1", "::1:1", "pi:0", "pi:65536", "pi:x", "pi:1x", "pi:-1", "[]:1x"}) {
        EXPECT_FALSE(parse_server_address(wrong)) << wrong;
    }
}

} // namespace
} // namespace scanloom::robot

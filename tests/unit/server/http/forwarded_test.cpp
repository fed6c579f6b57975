#include "server/http/forwarded.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace scanloom::http {
namespace {

TEST(Forwarded, IsReadOnlyWithTheSecretOfTheServers) {
    const std::string secret(64, 'a');
    for (const ForwardedFor& client : {ForwardedFor{"192.0.2.7", true}, ForwardedFor{"::1", false}}) {
        const auto text = forwarded_text(client, secret);
        EXPECT_EQ(parse_forwarded(text, secret), client);
        EXPECT_FALSE(parse_forwarded(text, std::string(64, 'b')));
        EXPECT_FALSE(parse_forwarded(text, "")) << "this server shares its store with no other";
        EXPECT_FALSE(parse_forwarded(text.substr(1), secret));
    }
    for (const std::string& other :
         std::vector<std::string>{"", secret, secret + " ", " http 192.0.2.7", secret + "https 192.0.2.7"}) {
        EXPECT_FALSE(parse_forwarded(other, secret)) << other;
    }
}

} // namespace
} // namespace scanloom::http

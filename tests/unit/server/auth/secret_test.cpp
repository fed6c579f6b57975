#include "server/auth/token.hpp"

#include "common/scan/limits.hpp"

#include <gtest/gtest.h>

namespace scanloom::auth {
namespace {

std::string secret() {
    std::array<std::byte, 32> random{};
    for (std::size_t n = 0; n < random.size(); ++n) random[n] = static_cast<std::byte>(7 * n + 3);
    return secret_of(random);
}

TEST(Secret, HasAPrefixAndAllItsBits) {
    EXPECT_EQ(secret().size(), 9U + 64U);
    EXPECT_TRUE(secret().starts_with("scanloom_030a11"));
    std::array<std::byte, 32> one{};
    one[31] = std::byte{1};
    EXPECT_NE(secret_of(one), secret_of({}));
}

TEST(Secret, IsNotAValidName) { EXPECT_FALSE(is_valid_name(secret())); }

TEST(Secret, HashIsSha256) {
    // The one-block example of FIPS 180-4.
    EXPECT_EQ(hash_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_TRUE(is_hash(hash_of(secret())));
    EXPECT_FALSE(is_hash(secret()));
    EXPECT_FALSE(is_hash(std::string(64, 'A')));
}

TEST(Secret, IsRemovedFromLogText) {
    const auto whole = secret();
    EXPECT_EQ(without_secrets("a " + whole + " b"), "a scanloom_... b");
    EXPECT_EQ(without_secrets("\"" + whole.substr(0, 63) + "...\""), "\"scanloom_......\"");
    EXPECT_EQ(without_secrets(whole + whole), "scanloom_...scanloom_...");
    EXPECT_EQ(without_secrets(whole + "/" + whole), "scanloom_.../scanloom_...");
}

TEST(Secret, OtherTextIsUnchanged) {
    for (const auto* text : {"", "scanloom", "scanloom_", "scanloom_links_open 3", "scanloom_add 1", "a scanloom_b"}) {
        EXPECT_EQ(without_secrets(text), text);
    }
}

} // namespace
} // namespace scanloom::auth

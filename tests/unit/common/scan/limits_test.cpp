#include "common/scan/limits.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <string>

namespace scanloom {
namespace {

TEST(IsValidName, AcceptsOneToSixtyFourAllowedCharacters) {
    EXPECT_TRUE(is_valid_name("a"));
    EXPECT_TRUE(is_valid_name("Intel_Lab-2"));
    EXPECT_TRUE(is_valid_name(std::string(64, 'x')));
    EXPECT_FALSE(is_valid_name(""));
    EXPECT_FALSE(is_valid_name(std::string(65, 'x')));
}

TEST(IsValidName, AcceptsOnlyLettersDigitsUnderscoreAndHyphen) {
    for (int byte = 0; byte < 256; ++byte) {
        const bool allowed = byte < 128 && (std::isalnum(byte) != 0 || byte == '_' || byte == '-');
        const char character = static_cast<char>(byte);
        EXPECT_EQ(is_valid_name({&character, 1}), allowed) << byte;
        EXPECT_EQ(is_valid_name(std::string("ab") + character), allowed) << byte;
    }
}

} // namespace
} // namespace scanloom

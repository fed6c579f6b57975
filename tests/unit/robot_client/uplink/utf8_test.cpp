#include "robot_client/uplink/utf8.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

TEST(Utf8, TextOfAnyLanguageIs) {
    for (const auto* text :
         {"", "laser", "\xc3\xa4", "\xe2\x82\xac", "\xf0\x9f\xa4\x96", "a\xc3\xa4z", "\xf4\x8f\xbf\xbf"}) {
        EXPECT_TRUE(is_utf8(text)) << text;
    }
    EXPECT_EQ(first_character("\xe2\x82\xac!")->value, U'\u20ac');
    EXPECT_EQ(first_character("\xe2\x82\xac!")->size, 3U);
}

TEST(Utf8, BytesThatAreCutShortOrLongerThanNeededOrNoCharacterAreNot) {
    for (const auto* text : {"\xff", "a\x80", "\xc3", "\xc3(", "\xe2\x82", "\xc0\x80", "\xe0\x80\xaf", "\xed\xa0\x80",
                             "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80"}) {
        EXPECT_FALSE(is_utf8(text)) << text;
    }
}

} // namespace
} // namespace scanloom::robot

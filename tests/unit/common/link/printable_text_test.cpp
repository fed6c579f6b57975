#include "common/link/printable_text.hpp"

#include <gtest/gtest.h>

namespace scanloom::link {
namespace {

TEST(PrintableText, PrintableTextIsUnchanged) {
    for (const std::string_view text : {"", "scan 3 is missing; send it", "C:\\x",
                                        "stra\xc3\x9f"
                                        "e",
                                        "\xc2\xa0\xe2\x82\xac", "\xf0\x9f\xa4\x96"}) {
        EXPECT_EQ(printable(text), text);
    }
}

TEST(PrintableText, ControlCharactersAreEscaped) {
    EXPECT_EQ(printable("a\x1b[2J\r\nb\x7f"), R"(a\x1b[2J\x0d\x0ab\x7f)");
    EXPECT_EQ(printable(std::string_view("a\0b", 3)), R"(a\x00b)");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m \xc2\x80 \xc2\x9f"),
              R"(\xc2\x9b31m \xc2\x80 \xc2\x9f)")
        << "C1 as UTF-8";
    EXPECT_EQ(printable("\x9b"
                        "31m"),
              R"(\x9b31m)")
        << "C1 as a byte";
}

TEST(PrintableText, DirectionAndLineSeparatorsAreEscaped) {
    EXPECT_EQ(printable("bad \u202etxt.exe"), R"(bad \xe2\x80\xaetxt.exe)");
    for (const std::string_view text : {"\u061c", "\u200e", "\u200f", "\u2028", "\u2029", "\u202a", "\u202b", "\u202c",
                                        "\u202d", "\u202e", "\u2066", "\u2067", "\u2068", "\u2069"}) {
        EXPECT_TRUE(printable(text).starts_with(R"(\x)")) << text;
    }
    for (const std::string_view text :
         {"\u061b", "\u200d", "\u2010", "\u2027", "\u202f", "\u2065", "\u206a", "\u05e9\u05dc\u05d5\u05dd"}) {
        EXPECT_EQ(printable(text), text);
    }
}

TEST(PrintableText, InvalidBytesAreEscaped) {
    EXPECT_EQ(printable("\xff\xfe"), R"(\xff\xfe)");
    EXPECT_EQ(printable("\xc3"), R"(\xc3)") << "cut short";
    EXPECT_EQ(printable("\xc0\x9b"
                        "\xe0\x82\x9b"
                        "\xf0\x80\x82\x9b"),
              R"(\xc0\x9b\xe0\x82\x9b\xf0\x80\x82\x9b)")
        << "an overlong encoding of a control character";
    EXPECT_EQ(printable("\xed\xa0\x80"), R"(\xed\xa0\x80)") << "half of a UTF-16 pair";
    EXPECT_EQ(printable("\xf4\x90\x80\x80"), R"(\xf4\x90\x80\x80)") << "beyond Unicode";
    EXPECT_EQ(printable("\xf9\x80\x80\x80"), R"(\xf9\x80\x80\x80)") << "no first byte";
}

TEST(PrintableText, IsCutBetweenCharacters) {
    EXPECT_EQ(printable(std::string(kPrintableTextMax, 'a')), std::string(kPrintableTextMax, 'a'));
    EXPECT_EQ(printable(std::string(1'000'000, 'a')), std::string(kPrintableTextMax, 'a') + "...");
    EXPECT_EQ(printable(std::string(kPrintableTextMax - 1, 'a') + "\xc3\x9f"),
              std::string(kPrintableTextMax - 1, 'a') + "...");
    EXPECT_EQ(printable(std::string(1'000, '\x1b')).size(), kPrintableTextMax + 3);
}

TEST(Utf8, AcceptsTextOfAnyLanguage) {
    for (const auto* text :
         {"", "laser", "\xc3\xa4", "\xe2\x82\xac", "\xf0\x9f\xa4\x96", "a\xc3\xa4z", "\xf4\x8f\xbf\xbf"}) {
        EXPECT_TRUE(is_utf8(text)) << text;
    }
}

TEST(Utf8, RejectsTruncatedOverlongAndInvalidSequences) {
    for (const auto* text : {"\xff", "a\x80", "\xc3", "\xc3(", "\xe2\x82", "\xc0\x80", "\xe0\x80\xaf", "\xed\xa0\x80",
                             "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80"}) {
        EXPECT_FALSE(is_utf8(text)) << text;
    }
}

} // namespace
} // namespace scanloom::link

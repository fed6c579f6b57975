#include "common/app/settings.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace scanloom {
namespace {

TEST(ConfigText, RejectsFilesAboveTheMaximum) {
    std::istringstream largest(std::string(kConfigBytesMax, '\n'));
    EXPECT_EQ(read_config_text(largest).value().size(), kConfigBytesMax);
    std::istringstream larger(std::string(kConfigBytesMax + 1, '\n'));
    EXPECT_EQ(read_config_text(larger).error().code, Errc::kFull);
    std::istringstream nothing("");
    EXPECT_EQ(read_config_text(nothing).value(), "");
}

TEST(ConfigText, KeepsSettings) {
    const std::string text = "a = \"x\"\n[simulate]\nseed = 5\r\n\n'b' = 'y'\npath = C:/x\n";
    EXPECT_EQ(one_line_a_setting(text).value(), text);
    EXPECT_EQ(one_line_a_setting("").value(), "");
}

TEST(ConfigText, RemovesCommentsButNotHashInStrings) {
    EXPECT_EQ(one_line_a_setting("# it's \"one\" [\na = 1 # two\n# three").value(), "\na = 1 \n");
    EXPECT_EQ(one_line_a_setting(R"(a = "#1" # b)").value(), R"(a = "#1" )");
}

TEST(ConfigText, PutsAnArrayOnOneLine) {
    EXPECT_EQ(one_line_a_setting("a = [\n  \"x]\", # first\n  'y',\n]\nb = 1\n").value(),
              "a = [   \"x]\",    'y', ]\nb = 1\n");
}

TEST(ConfigText, EscapedQuotesDoNotEndABasicString) {
    const std::string basic = R"(a = "say \"hi\"")";
    EXPECT_EQ(one_line_a_setting(basic).value(), basic);
    const std::string literal = R"(a = 'C:\')";
    EXPECT_EQ(one_line_a_setting(literal).value(), literal);
}

TEST(ConfigText, ReportsTheLineOfUnclosedText) {
    const std::vector<std::pair<std::string, std::string>> cases = {
        {"a = 1\nb = \"x\nc = \"y\"\n", "2: a string is not closed; end it with \""},
        {"a = 'x", "1: a string is not closed; end it with '"},
        {"a = x\"", "1: a string is not closed; end it with \""},
        {"a = \"x\\\"", "1: a string is not closed; end it with \""},
        {"a = \"\"\"x\ny\"\"\"", "1: there is more behind the \"; put one value, or a comma between two"},
        {"\na = [\"x\",\n\"y\"\nb = 1\n", "2: a [ is not closed; end it with ]"},
        {"\na = [1,\n2\n", "2: a [ is not closed; end it with ]"},
        {"a = 1\n[simulate\nseed = 1\n", "2: a [ is not closed; end it with ]"},
        {"a = 1]", "1: there is a ] without a [ before it; remove it"},
        {"a = [1] 2\n", "1: there is more behind the ]; put one value, or a comma between two"},
        {"a = \"x\"y\n", "1: there is more behind the \"; put one value, or a comma between two"},
    };
    for (const auto& [text, message] : cases) {
        const auto settings = one_line_a_setting(text);
        ASSERT_FALSE(settings) << text;
        EXPECT_EQ(settings.error(), (Error{Errc::kMalformed, message})) << text;
    }
}

} // namespace
} // namespace scanloom

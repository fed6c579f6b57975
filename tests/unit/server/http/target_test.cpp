#include "server/http/target.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Optional;

TEST(Target, PathIsSplitThenDecoded) {
    EXPECT_THAT(parse_target("/")->segments, ElementsAre(""));
    EXPECT_THAT(parse_target("/api/v1/sessions")->segments, ElementsAre("api", "v1", "sessions"));
    EXPECT_THAT(parse_target("/a%62c/d")->segments, ElementsAre("abc", "d"));
    EXPECT_THAT(parse_target("/a//b/")->segments, ElementsAre("a", "", "b", ""));
    EXPECT_THAT(parse_target("//evil.example/x")->segments, ElementsAre("", "evil.example", "x"));
}

TEST(Target, QueryIsDecoded) {
    const auto target = parse_target("/x?bbox=-1.5,2%2C3,4&after=caf%C3%A9&flag");
    ASSERT_TRUE(target);
    EXPECT_THAT(target->query.find("bbox"), Optional(std::string_view("-1.5,2,3,4")));
    EXPECT_THAT(target->query.find("after"), Optional(std::string_view("caf\xC3\xA9")));
    EXPECT_THAT(target->query.find("flag"), Optional(std::string_view("")));
    EXPECT_EQ(target->query.find("missing"), std::nullopt);
    EXPECT_TRUE(parse_target("/x?")->query.check_only({})) << "a bare '?'";
}

TEST(Target, OtherTargetsAreRefused) {
    for (const auto* text :
         {"", "x", "http://host/x", "*", "host:80", "/a b", "/%", "/%4", "/%zz", "/\x01", "/a#b", "/caf\xC3\xA9"}) {
        const auto target = parse_target(text);
        ASSERT_FALSE(target) << text;
        EXPECT_EQ(target.error().code, Errc::kMalformed) << text;
    }
}

TEST(Target, DotSegmentsAreRefused) {
    for (const auto* text : {"/..", "/a/../b", "/a/.", "/%2e%2E/etc/passwd", "/assets/..%2f..%2fetc", "/a%5Cb",
                             "/a%00b", "/a%0Ab", "/a%7Fb"}) {
        const auto target = parse_target(text);
        ASSERT_FALSE(target) << text;
        EXPECT_EQ(target.error().code, Errc::kMalformed) << text;
    }
}

TEST(Target, DuplicateParameterIsNamed) {
    const auto target = parse_target("/x?since=1&since=2");
    ASSERT_FALSE(target);
    EXPECT_EQ(target.error().code, Errc::kInvalidField);
    EXPECT_THAT(target.error().message, HasSubstr("\"since\""));
}

TEST(Query, UnknownParametersAreNamed) {
    const auto target = parse_target("/x?since=1&sinc=2");
    ASSERT_TRUE(target);
    EXPECT_TRUE(target->query.check_only({"since", "sinc"}));
    const auto checked = target->query.check_only({"layer", "since"});
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, Errc::kInvalidField);
    EXPECT_THAT(checked.error().message, AllOf(HasSubstr("\"sinc\""), HasSubstr("layer, since")));
}

TEST(Query, UnprintableTextIsEscapedInErrors) {
    const auto target = parse_target("/x?%1B%5B31m%FF=1");
    ASSERT_TRUE(target);
    EXPECT_THAT(target->query.check_only({}).error().message, HasSubstr("\"?[31m?\""));
}

} // namespace
} // namespace scanloom::http

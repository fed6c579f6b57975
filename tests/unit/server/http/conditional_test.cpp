#include "server/http/header_fields.hpp"

#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

TEST(IfNoneMatch, TagMatchesOnlyItself) {
    EXPECT_TRUE(if_none_match_has("\"a-1\"", "\"a-1\""));
    EXPECT_FALSE(if_none_match_has("\"a-2\"", "\"a-1\""));
    EXPECT_FALSE(if_none_match_has("", "\"a-1\""));
}

TEST(IfNoneMatch, AnyTagOfAListMatches) {
    EXPECT_TRUE(if_none_match_has("\"x\", \"a-1\" ,\"y\"", "\"a-1\""));
    EXPECT_TRUE(if_none_match_has(" \"x\",,\"a-1\"", "\"a-1\""));
    EXPECT_FALSE(if_none_match_has("\"x\", \"y\"", "\"a-1\""));
}

TEST(IfNoneMatch, WeakTagsMatchStrongOnes) {
    EXPECT_TRUE(if_none_match_has("W/\"a-1\"", "\"a-1\""));
    EXPECT_TRUE(if_none_match_has("\"x\", W/\"a-1\"", "\"a-1\""));
}

TEST(IfNoneMatch, AsteriskMatchesAnyTag) {
    EXPECT_TRUE(if_none_match_has("*", "\"a-1\""));
    EXPECT_TRUE(if_none_match_has(" * ", "\"a-1\""));
    EXPECT_FALSE(if_none_match_has("*, \"a-1\"", "\"a-1\""));
}

TEST(IfNoneMatch, CommasInATagDoNotSplitIt) {
    EXPECT_TRUE(if_none_match_has("\"a,b\"", "\"a,b\""));
    EXPECT_FALSE(if_none_match_has("\"a,b\"", "\"b\""));
}

TEST(IfNoneMatch, InvalidListsMatchNothing) {
    for (const auto* field : {"a-1", "\"a-1", "\"a-1\" \"b\"", "W\"a-1\"", "w/\"a-1\"", "\"a-1\"; x", ","}) {
        EXPECT_FALSE(if_none_match_has(field, "\"a-1\"")) << field;
    }
}

} // namespace
} // namespace scanloom::http

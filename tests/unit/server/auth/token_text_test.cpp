#include "server/auth/token_text.hpp"

#include "server/auth/token.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::auth {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string hash(char digit) { return std::string(64, digit); }

/// Lines 1 to 5.
std::string stanza(std::string_view name, char digit) {
    return fmt::format("[[token]]\nname = \"{}\"\nsha256 = \"{}\"\nrole = \"robot\"\nsessions = [\"*\"]\n", name,
                       hash(digit));
}

std::string fault(const std::string& toml) {
    const auto tokens = parse_tokens(toml);
    return tokens ? "taken" : tokens.error().message;
}

/// Returns the stanza with one line replaced.
std::string fault_with(const std::string& key, const std::string& line) {
    std::string toml;
    const auto whole = stanza("a", '1');
    for (std::size_t at = 0; at < whole.size();) {
        const auto end = whole.find('\n', at) + 1;
        toml += whole.compare(at, key.size(), key) == 0 ? line : whole.substr(at, end - at);
        at = end;
    }
    return fault(toml);
}

TEST(TokenText, TokenHasTheWrittenValues) {
    const auto tokens =
        parse_tokens("# ours\n[[token]]\nname = \"depot\"\nsha256 = \"" + hash('a') +
                     "\"\nrole = \"viewer\"\nsessions = [\"depot-*\", # both\n  \"lab\"]\n"
                     "limits = { connections = 2, beams = 720, bytes_per_second = 2e4, cells = 4096 }\n" +
                     stanza("other", 'b'))
            .value();
    ASSERT_EQ(tokens.tokens().size(), 2U);
    const Token& token = *tokens.tokens()[0];
    EXPECT_EQ(token.name, "depot");
    EXPECT_EQ(token.hash, hash('a'));
    EXPECT_EQ(token.role, Role::kViewer);
    EXPECT_THAT(token.sessions, ElementsAre("depot-*", "lab"));
    Limits limits;
    limits.connections = 2;
    limits.beams = 720;
    limits.bytes_per_second = 2e4;
    limits.cells = 4096;
    EXPECT_EQ(token.limits, limits);
    EXPECT_EQ(tokens.tokens()[1]->limits, Limits{});
}

TEST(TokenText, WrittenTextIsReadBack) {
    Token token{"depot", hash_of("x"), Role::kOperator, {"lab", "depot-?"}, {}};
    EXPECT_EQ(*parse_tokens(text_of(token)).value().tokens()[0], token);
    EXPECT_THAT(text_of(token), Not(HasSubstr("limits")));
    token.limits = {3, 5000.5, 4, 5, 6, 7};
    EXPECT_EQ(*parse_tokens(text_of(token)).value().tokens()[0], token);
}

TEST(TokenText, ErrorsNameTheLineAndTheFix) {
    EXPECT_THAT(fault("a = \n"), StartsWith("1: this is no TOML"));
    EXPECT_THAT(fault("\n\ntokens = 1\n"), AllOf(StartsWith("3: 'tokens' is unknown"), HasSubstr("[[token]]")));
    EXPECT_THAT(fault("[token]\nname = \"a\"\n"), HasSubstr("'token' is unknown"));
    EXPECT_THAT(fault("token = [1]\n"), HasSubstr("is no [[token]]"));
    EXPECT_THAT(fault_with("name", ""), AllOf(StartsWith("1: name is missing"), HasSubstr("add it")));
    EXPECT_THAT(fault_with("name", "name = 3\n"), StartsWith("2: name is not a text"));
    EXPECT_THAT(fault_with("name", "name = \"a b\"\n"), StartsWith("2: name is 'a b'; use 1 to 64"));
    EXPECT_THAT(fault_with("sha256", ""), StartsWith("1: sha256 is missing"));
    EXPECT_THAT(fault_with("role", "role = \"admin\"\n"), StartsWith("4: role is 'admin'; use robot"));
    EXPECT_THAT(fault_with("sessions", ""), StartsWith("1: sessions is missing"));
    EXPECT_THAT(fault_with("sessions", "sessions = \"*\"\n"), StartsWith("5: sessions is no list"));
    EXPECT_THAT(fault_with("sessions", "sessions = []\n"), StartsWith("5: sessions is no list"));
    EXPECT_THAT(fault_with("sessions", "sessions = [\"a\",\n\"b/c\"]\n"), StartsWith("6: 'b/c' is no pattern"));
    EXPECT_THAT(fault_with("role", "rolle = \"robot\"\n"), StartsWith("4: 'rolle' is unknown in a [[token]]"));
}

TEST(TokenText, BracketsWithoutANameAreRefused) {
    for (const auto* wrong : {"[[[token]]]", "[&", "[", "[[", "[[ ]]", "[]", "  [ .a]", "[[\t!]]", "[=]", "a = [}"}) {
        EXPECT_THAT(fault(fmt::format("# one\n{}\n", wrong)), HasSubstr(": this is no TOML: ")) << wrong;
    }
    EXPECT_THAT(fault("[ \"a\" ]\n"), HasSubstr("unknown here"));
    EXPECT_THAT(fault("token = [\n  1 ]\n"), HasSubstr("[[token]]"));
}

TEST(TokenText, NonAsciiIsAcceptedOnlyInComments) {
    const std::string comment = "# J\u00fcrgen's \"tablet\" \xcc\xaa \xff\n";
    EXPECT_THAT(fault("\xef\xbb\xbf"
                      "a = 1\n"),
                StartsWith("1: 'a' is unknown"));
    EXPECT_THAT(fault(comment + "name = \"a#b\" " + comment + "\n"), StartsWith("2: 'name' is unknown"));
    for (const auto* line : {"\xcc\xaa", "name = \"\u00fc\"", "[\u00fc]", "d = 1979-05-2\xc9\xab", "a = 'x' \xff # c",
                             "a = \"\\\"#\xff\"", "\xef\xbb\xbf[[token]]"}) {
        EXPECT_THAT(fault(fmt::format("# one\n{}\n", line)), AllOf(StartsWith("2: "), HasSubstr("ASCII"))) << line;
    }
}

TEST(TokenText, LimitsOutOfBoundsAreRefused) {
    const auto with = [](const std::string& limits) { return fault(stanza("a", '1') + "limits = " + limits + "\n"); };
    EXPECT_EQ(with("{ sensors = 64, beams = 4096, bytes_per_second = 1024 }"), "taken");
    EXPECT_THAT(with("{ sensors = 65 }"), StartsWith("6: sensors is not a whole number from 1 to 64"));
    EXPECT_THAT(with("{ connections = 0 }"), StartsWith("6: connections is not"));
    EXPECT_THAT(with("{ connections = -1 }"), StartsWith("6: connections is not"));
    EXPECT_THAT(with("{ connections = 1.5 }"), StartsWith("6: connections is not"));
    EXPECT_THAT(with("{ bytes_per_second = nan }"), StartsWith("6: bytes_per_second is not a number"));
    EXPECT_THAT(with("{ bytes_per_second = 1023 }"), StartsWith("6: bytes_per_second is not a number"));
    EXPECT_THAT(with("{ robots = 1 }"), AllOf(StartsWith("6: 'robots' is no limit"), HasSubstr("connections")));
    EXPECT_THAT(with("8"), StartsWith("6: limits is no table"));
}

TEST(TokenText, DuplicateNamesAndSecretsAreRefused) {
    EXPECT_THAT(fault(stanza("a", '1') + stanza("a", '2')), StartsWith("6: there is a token of the name 'a' already"));
    EXPECT_THAT(fault(stanza("a", '1') + stanza("b", '1')), StartsWith("6: 'a' and 'b' have the same secret"));
}

TEST(TokenText, SecretInPlaceOfTheHashIsNotPrinted) {
    const auto secret = secret_of({});
    const auto message = fault_with("sha256", "sha256 = \"" + secret + "\"\n");
    EXPECT_THAT(message, AllOf(StartsWith("3: sha256 is not 64 digits"), Not(HasSubstr(secret.substr(0, 20)))));
}

TEST(TokenText, FileWithoutTokensIsRefused) {
    EXPECT_THAT(fault(""), HasSubstr("there is no [[token]]"));
    EXPECT_THAT(fault("# nothing\n"), HasSubstr("there is no [[token]]"));
}

} // namespace
} // namespace scanloom::auth

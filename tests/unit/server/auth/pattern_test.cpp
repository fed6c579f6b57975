#include "server/auth/token.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace scanloom::auth {
namespace {

/// The definition as a simple, slow function.
bool oracle(std::string_view pattern, std::string_view name) {
    if (pattern.empty()) return name.empty();
    if (pattern[0] == '*') return oracle(pattern.substr(1), name) || (!name.empty() && oracle(pattern, name.substr(1)));
    return !name.empty() && (pattern[0] == '?' || pattern[0] == name[0]) && oracle(pattern.substr(1), name.substr(1));
}

TEST(Pattern, AgreesWithTheReferenceMatcher) {
    std::mt19937 random(7);
    const auto text = [&](std::string_view letters, std::size_t size_max) {
        std::string made(random() % (size_max + 1), ' ');
        for (char& c : made) c = letters[random() % letters.size()];
        return made;
    };
    std::size_t matching = 0;
    for (int n = 0; n < 200'000; ++n) {
        const auto pattern = text("ab*?", 6);
        const auto name = text("ab", 8);
        ASSERT_EQ(matches(pattern, name), oracle(pattern, name)) << pattern << " " << name;
        matching += matches(pattern, name) ? 1U : 0U;
    }
    EXPECT_GT(matching, 10'000U);
    EXPECT_LT(matching, 190'000U);
}

TEST(Pattern, PlainWordMatchesOnlyItself) {
    EXPECT_TRUE(matches("lab", "lab"));
    EXPECT_FALSE(matches("lab", "lab2"));
    EXPECT_FALSE(matches("lab", "la"));
    EXPECT_FALSE(matches("lab", "LAB"));
    EXPECT_FALSE(matches("", "lab"));
}

TEST(Pattern, ManyStarsMatchInBoundedTime) {
    // Trying all divisions of the name would take 2^60 steps.
    std::string pattern;
    for (int n = 0; n < 31; ++n) pattern += "*a";
    EXPECT_FALSE(matches(pattern, std::string(64, 'b')));
    EXPECT_FALSE(matches(pattern + "c", std::string(64, 'a')));
    EXPECT_TRUE(matches(pattern, std::string(64, 'a')));
}

TEST(Pattern, AcceptsNameCharactersAndWildcards) {
    for (const auto* valid : {"*", "?", "lab-*", "A_9-?"}) EXPECT_TRUE(is_valid_pattern(valid)) << valid;
    for (const auto* wrong : {"", "a b", "lab/*", "[ab]", "a\n", "ä"}) EXPECT_FALSE(is_valid_pattern(wrong)) << wrong;
    EXPECT_TRUE(is_valid_pattern(std::string(64, '*')));
    EXPECT_FALSE(is_valid_pattern(std::string(65, 'a')));
}

} // namespace
} // namespace scanloom::auth

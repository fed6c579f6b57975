#include "server/auth/token.hpp"

#include <gtest/gtest.h>

namespace scanloom::auth {
namespace {

TokenRef token(std::string name, std::string_view secret) {
    return std::make_shared<const Token>(Token{std::move(name), hash_of(secret), Role::kRobot, {"*"}, {}});
}

TEST(TokenSet, FindsEachTokenByItsSecret) {
    const TokenSet tokens({token("a", "secret a"), token("b", "secret b"), token("c", "secret c")});
    EXPECT_EQ(tokens.find("secret a")->name, "a");
    EXPECT_EQ(tokens.find("secret b")->name, "b");
    EXPECT_EQ(tokens.find("secret c")->name, "c");
    for (const auto& wrong : {std::string(), std::string("secret"), std::string("secret d"), hash_of("secret a")}) {
        EXPECT_EQ(tokens.find(wrong), nullptr) << wrong;
    }
    EXPECT_EQ(TokenSet().find("secret a"), nullptr);
}

TEST(Token, PermitsSessionsOfItsPatterns) {
    const Token two{"a", "", Role::kViewer, {"lab", "depot-*"}, {}};
    EXPECT_TRUE(is_for(two, "lab"));
    EXPECT_TRUE(is_for(two, "depot-7"));
    EXPECT_FALSE(is_for(two, "depot"));
    EXPECT_FALSE(is_for_all(two));
    EXPECT_FALSE(is_for_all({"b", "", Role::kViewer, {"**a"}, {}}));
    EXPECT_TRUE(is_for_all({"b", "", Role::kViewer, {"x", "*"}, {}}));
}

TEST(Token, DefaultTokenPermitsEverything) {
    EXPECT_TRUE(permits(default_token()->role, Action::kChange));
    EXPECT_TRUE(is_for_all(*default_token()));
}

TEST(Role, PermitsItsOwnActions) {
    for (const Role role : kRoles) {
        EXPECT_EQ(permits(role, Action::kDrive), role != Role::kViewer);
        EXPECT_EQ(permits(role, Action::kRead), role != Role::kRobot);
        EXPECT_EQ(permits(role, Action::kChange), role == Role::kOperator);
        EXPECT_EQ(role_of(name_of(role)), role);
    }
    EXPECT_EQ(role_of("admin"), std::nullopt);
}

} // namespace
} // namespace scanloom::auth

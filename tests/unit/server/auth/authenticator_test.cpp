#include "server/auth/authenticator.hpp"

#include "server/auth/token.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::auth {
namespace {

using auth::Reason;
using auth::Role;
using auth::Token;
using auth::TokenRef;
using auth::TokenSet;
using testing::HasSubstr;

TokenRef token(std::string name, Role role, std::vector<std::string> sessions = {"*"}, std::size_t connections = 8) {
    Token made{std::move(name), "", role, std::move(sessions), {}};
    made.hash = auth::hash_of("secret of " + made.name);
    made.limits.connections = connections;
    return std::make_shared<const Token>(std::move(made));
}

template <class T>
std::pair<Reason, std::string> refusal(const Admitted<T>& admitted) {
    return {admitted.error().reason, admitted.error().token};
}

TEST(Authenticator, IsOpenWithoutTokens) {
    Authenticator authenticator;
    EXPECT_TRUE(authenticator.is_open());
    EXPECT_EQ(authenticator.admit("").value(), auth::default_token());
    EXPECT_TRUE(authenticator.grant_robot_link("", "lab", "r").value()->token());
    EXPECT_TRUE(authenticator.grant_viewing(auth::default_token(), "lab").value()->token());
}

TEST(Authenticator, AdmitsOnlyWhatTheTokenPermits) {
    Authenticator authenticator(TokenSet({token("robot", Role::kRobot, {"depot-*"}), token("viewer", Role::kViewer)}));
    EXPECT_FALSE(authenticator.is_open());
    EXPECT_EQ(authenticator.grant_robot_link("secret of robot", "depot-1", "r").value()->token()->name, "robot");
    using Refusal = std::pair<Reason, std::string>;
    EXPECT_EQ(refusal(authenticator.grant_robot_link("", "depot-1", "r")), Refusal(Reason::kNoToken, ""));
    EXPECT_EQ(refusal(authenticator.grant_robot_link("guess", "depot-1", "r")), Refusal(Reason::kUnknownToken, ""));
    EXPECT_EQ(refusal(authenticator.grant_robot_link("secret of robot", "lab", "r")),
              Refusal(Reason::kWrongSession, "robot"));
    EXPECT_EQ(refusal(authenticator.grant_robot_link("secret of viewer", "lab", "r")),
              Refusal(Reason::kWrongRole, "viewer"));
    EXPECT_TRUE(authenticator.grant_viewing(authenticator.admit("secret of viewer").value(), "lab"));
    EXPECT_EQ(refusal(authenticator.grant_viewing(authenticator.admit("secret of robot").value(), "depot-1")),
              Refusal(Reason::kWrongRole, "robot"));
}

TEST(Authenticator, RobotsBeyondTheConnectionLimitAreRefused) {
    Authenticator authenticator(
        TokenSet({token("two", Role::kRobot, {"*"}, 2), token("other", Role::kRobot, {"*"}, 1)}));
    auto first = authenticator.grant_robot_link("secret of two", "lab", "a").value();
    const auto second = authenticator.grant_robot_link("secret of two", "lab", "b").value();
    const auto refused = authenticator.grant_robot_link("secret of two", "lab", "c");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().reason, Reason::kLimit);
    EXPECT_EQ(refused.error().error.code, Errc::kOverloaded);
    EXPECT_THAT(refused.error().error.message, AllOf(HasSubstr("'two'"), HasSubstr("`connections`")));
    EXPECT_TRUE(authenticator.grant_robot_link("secret of other", "lab", "c"));
    const auto again = authenticator.grant_robot_link("secret of two", "lab", "b"); // its old link still exists
    EXPECT_TRUE(again);
    EXPECT_FALSE(authenticator.grant_robot_link("secret of two", "depot", "b")); // of the same name, elsewhere
    first.reset();
    EXPECT_TRUE(authenticator.grant_robot_link("secret of two", "lab", "c"));
}

TEST(Authenticator, CredentialsEndWithTheirPermission) {
    Authenticator authenticator(TokenSet(
        {token("a", Role::kRobot), token("b", Role::kRobot), token("c", Role::kOperator), token("d", Role::kRobot)}));
    std::map<std::string, int> changes;
    std::map<std::string, std::shared_ptr<Credential>> credentials;
    for (const std::string name : {"a", "b", "c", "d"}) {
        credentials[name] = authenticator.grant_robot_link("secret of " + name, "lab", "robot-" + name).value();
        credentials[name]->when_changed([&changes, name] { ++changes[name]; });
    }
    credentials["watch"] = authenticator.grant_viewing(authenticator.admit("secret of c").value(), "lab").value();
    EXPECT_TRUE(changes.empty());
    // a is unchanged, b is removed, c has become a viewer, d is for other sessions.
    authenticator.replace(
        TokenSet({token("a", Role::kRobot, {"*"}, 3), token("c", Role::kViewer), token("d", Role::kRobot, {"x"})}));
    EXPECT_EQ(credentials["a"]->token()->limits.connections, 3U);
    for (const auto* gone : {"b", "c", "d"}) EXPECT_EQ(credentials[gone]->token(), nullptr) << gone;
    EXPECT_NE(credentials["watch"]->token(), nullptr);
    for (const auto* name : {"a", "b", "c", "d"}) EXPECT_EQ(changes[name], 1) << name;
}

TEST(Authenticator, LateCallbackIsCalledAtOnce) {
    Authenticator authenticator(TokenSet({token("a", Role::kRobot)}));
    const auto credential = authenticator.grant_robot_link("secret of a", "lab", "r").value();
    authenticator.replace(TokenSet({token("b", Role::kRobot)}));
    bool was_called = false;
    credential->when_changed([&] { was_called = true; });
    EXPECT_TRUE(was_called);
}

TEST(Authenticator, FirstTokensEndEarlierPasses) {
    Authenticator authenticator;
    const auto credential = authenticator.grant_robot_link("", "lab", "r").value();
    authenticator.replace(TokenSet({token("a", Role::kRobot)}));
    EXPECT_EQ(credential->token(), nullptr);
}

TEST(Authenticator, RefusesViewersWhoseTokenWasRemoved) {
    Authenticator authenticator;
    const auto before = authenticator.admit("").value();
    authenticator.replace(TokenSet({token("a", Role::kViewer)}));
    using Refusal = std::pair<Reason, std::string>;
    EXPECT_EQ(refusal(authenticator.grant_viewing(before, "lab")), Refusal(Reason::kNoToken, ""));
    const auto a = authenticator.admit("secret of a").value();
    authenticator.replace(TokenSet({token("b", Role::kViewer)}));
    EXPECT_EQ(refusal(authenticator.grant_viewing(a, "lab")), Refusal(Reason::kUnknownToken, ""));
}

TEST(Authenticator, CredentialMayOutliveTheAuthenticator) {
    std::shared_ptr<Credential> credential;
    {
        Authenticator authenticator;
        credential = authenticator.grant_robot_link("", "lab", "r").value();
    }
    EXPECT_NE(credential->token(), nullptr);
}

} // namespace
} // namespace scanloom::auth

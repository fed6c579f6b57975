#include "server/auth/login_sessions.hpp"

#include "server/auth/token.hpp"

#include <gtest/gtest.h>

namespace scanloom::auth {
namespace {

auth::Token viewer() { return {"viewer", auth::hash_of("secret"), auth::Role::kViewer, {"*"}, {}}; }

TEST(LoginSessions, FindTheCurrentToken) {
    double now = 5.0;
    Authenticator authenticator(auth::TokenSet({std::make_shared<const auth::Token>(viewer())}));
    LoginSessions logins([&] { return now; });
    const auto cookie = logins.open(viewer());
    EXPECT_NE(cookie, logins.open(viewer()));
    EXPECT_EQ(logins.find(cookie, authenticator)->role, auth::Role::kViewer);
    EXPECT_EQ(logins.find("secret", authenticator), nullptr);

    auto promoted = viewer();
    promoted.role = auth::Role::kOperator;
    authenticator.replace(auth::TokenSet({std::make_shared<const auth::Token>(promoted)}));
    EXPECT_EQ(logins.find(cookie, authenticator)->role, auth::Role::kOperator);
    authenticator.replace(auth::TokenSet());
    EXPECT_EQ(logins.find(cookie, authenticator), nullptr);
}

TEST(LoginSessions, EndWhenRemovedOrExpired) {
    double now = 5.0;
    Authenticator authenticator(auth::TokenSet({std::make_shared<const auth::Token>(viewer())}));
    LoginSessions logins([&] { return now; });
    const auto closed = logins.open(viewer());
    const auto forgotten = logins.open(viewer());
    logins.close(closed);
    EXPECT_EQ(logins.find(closed, authenticator), nullptr);
    EXPECT_NE(logins.find(forgotten, authenticator), nullptr);
    now += auth::LoginTable::kIdleSeconds + 1.0;
    EXPECT_EQ(logins.find(forgotten, authenticator), nullptr);
}

} // namespace
} // namespace scanloom::auth

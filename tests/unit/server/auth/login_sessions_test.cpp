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

/// Two servers that share a database, and one of another database.
class SharedLoginsTest : public testing::Test {
protected:
    SharedLoginsTest() {
        a_.share("secret of the servers");
        b_.share("secret of the servers");
        other_.share("another secret");
    }

    double now_ = 5.0;
    double date_ = 1.8e9;
    Authenticator authenticator_{auth::TokenSet({std::make_shared<const auth::Token>(viewer())})};
    LoginSessions a_{[&] { return now_; }, [&] { return date_; }};
    LoginSessions b_{[&] { return now_; }, [&] { return date_ + 30.0; }}; // clocks differ
    LoginSessions other_{[&] { return now_; }, [&] { return date_; }};
};

TEST_F(SharedLoginsTest, ACookieIsValidOnAllServersAndOnNoOthers) {
    const auto cookie = a_.open(viewer());
    EXPECT_NE(a_.find(cookie, authenticator_), nullptr);
    EXPECT_NE(b_.find(cookie, authenticator_), nullptr);
    EXPECT_EQ(other_.find(cookie, authenticator_), nullptr);
    authenticator_.replace(auth::TokenSet());
    EXPECT_EQ(b_.find(cookie, authenticator_), nullptr);
}

TEST_F(SharedLoginsTest, AChangedCookieIsRefused) {
    const auto cookie = a_.open(viewer());
    for (std::size_t at = 0; at < cookie.size(); ++at) {
        auto changed = cookie;
        changed[at] = changed[at] == '1' ? '2' : '1';
        EXPECT_EQ(b_.find(changed, authenticator_), nullptr) << changed;
        EXPECT_EQ(b_.find(cookie.substr(0, at), authenticator_), nullptr);
    }
}

TEST_F(SharedLoginsTest, ItEndsWhereTheBrowserSignsOutAndWhenItIsOld) {
    const auto cookie = a_.open(viewer());
    b_.close(cookie);
    EXPECT_EQ(b_.find(cookie, authenticator_), nullptr);
    const auto old = a_.open(viewer());
    now_ += auth::LoginTable::kIdleSeconds + 1.0;
    date_ += auth::LoginTable::kIdleSeconds + 1.0;
    EXPECT_EQ(a_.find(old, authenticator_), nullptr);
    EXPECT_EQ(b_.find(old, authenticator_), nullptr);
}

} // namespace
} // namespace scanloom::auth

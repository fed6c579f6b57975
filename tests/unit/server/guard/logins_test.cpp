#include "server/guard/logins.hpp"

#include "server/access/secret.hpp"

#include <gtest/gtest.h>

namespace scanloom::guard {
namespace {

access::Token viewer() { return {"viewer", access::hash_of("secret"), access::Role::kViewer, {"*"}, {}}; }

TEST(Logins, LeadToTheTokenAsItIsInForceNow) {
    double now = 5.0;
    Gate gate(access::TokenSet({std::make_shared<const access::Token>(viewer())}));
    Logins logins([&] { return now; });
    const auto cookie = logins.open(viewer());
    EXPECT_NE(cookie, logins.open(viewer()));
    EXPECT_EQ(logins.find(cookie, gate)->role, access::Role::kViewer);
    EXPECT_EQ(logins.find("secret", gate), nullptr);

    auto promoted = viewer();
    promoted.role = access::Role::kOperator;
    gate.replace(access::TokenSet({std::make_shared<const access::Token>(promoted)}));
    EXPECT_EQ(logins.find(cookie, gate)->role, access::Role::kOperator);
    gate.replace(access::TokenSet());
    EXPECT_EQ(logins.find(cookie, gate), nullptr);
}

TEST(Logins, AreOverWhenGivenBackOrForgotten) {
    double now = 5.0;
    Gate gate(access::TokenSet({std::make_shared<const access::Token>(viewer())}));
    Logins logins([&] { return now; });
    const auto closed = logins.open(viewer());
    const auto forgotten = logins.open(viewer());
    logins.close(closed);
    EXPECT_EQ(logins.find(closed, gate), nullptr);
    EXPECT_NE(logins.find(forgotten, gate), nullptr);
    now += access::LoginTable::kIdleSeconds + 1.0;
    EXPECT_EQ(logins.find(forgotten, gate), nullptr);
}

} // namespace
} // namespace scanloom::guard

#include "server/http/header_fields.hpp"

#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

TEST(Credentials, BearerTokenFollowsTheScheme) {
    EXPECT_EQ(bearer_of("Bearer abc"), "abc");
    EXPECT_EQ(bearer_of("bearer   abc  "), "abc");
    for (const auto* wrong : {"", "Bearer", "Bearer ", "Bearer    ", "Basic abc", "abc", "Bearerabc"}) {
        EXPECT_EQ(bearer_of(wrong), std::nullopt) << wrong;
    }
}

TEST(Credentials, CookieIsFoundAmongOthers) {
    EXPECT_EQ(cookie_of("a=1; scanloom_login=xyz; b=2", kLoginCookie), "xyz");
    EXPECT_EQ(cookie_of("scanloom_login=x=y", kLoginCookie), "x=y");
    EXPECT_EQ(cookie_of("scanloom_login=", kLoginCookie), "");
    for (const auto* none :
         {"", ";;", "scanloom_login", "xscanloom_login=1", "scanloom_login2=1", "a=scanloom_login=1"}) {
        EXPECT_EQ(cookie_of(none, kLoginCookie), std::nullopt) << none;
    }
}

TEST(Credentials, CookieIsHttpOnlyAndSameSite) {
    EXPECT_EQ(set_login_cookie("x", false), "scanloom_login=x; Path=/; HttpOnly; SameSite=Strict");
    EXPECT_EQ(set_login_cookie("x", true), "scanloom_login=x; Path=/; HttpOnly; SameSite=Strict; Secure");
    EXPECT_EQ(set_login_cookie("", false), "scanloom_login=; Path=/; HttpOnly; SameSite=Strict; Max-Age=0");
}

} // namespace
} // namespace scanloom::http

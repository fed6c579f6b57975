#include "server/auth/login_sessions.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace scanloom::auth {
namespace {

TEST(LoginTable, CookieFindsItsTokenUntilRemoved) {
    LoginTable table;
    table.open("one", "hash a", 10.0);
    table.open("two", "hash b", 10.0);
    EXPECT_EQ(table.use("one", 11.0), "hash a");
    EXPECT_EQ(table.use("two", 11.0), "hash b");
    EXPECT_EQ(table.use("three", 11.0), std::nullopt);
    table.close("one");
    table.close("three");
    EXPECT_EQ(table.use("one", 11.0), std::nullopt);
    EXPECT_EQ(table.use("two", 11.0), "hash b");
}

TEST(LoginTable, ExpiresOnlyWithoutUse) {
    LoginTable table;
    table.open("one", "hash", 0.0);
    EXPECT_TRUE(table.use("one", LoginTable::kIdleSeconds));
    EXPECT_TRUE(table.use("one", 2 * LoginTable::kIdleSeconds));
    EXPECT_FALSE(table.use("one", 3 * LoginTable::kIdleSeconds + 1.0));
    EXPECT_EQ(table.size(), 0U);
}

TEST(LoginTable, FullTokenEvictsOnlyItsOwnLogins) {
    LoginTable table;
    table.open("other", "b", 0.0);
    for (std::size_t n = 0; n < 1000; ++n) table.open(fmt::format("{}", n), "a", 1.0 + static_cast<double>(n));
    EXPECT_EQ(table.size(), LoginTable::kLoginsOfTokenMax + 1);
    EXPECT_TRUE(table.use("other", 1001.0));
    EXPECT_TRUE(table.use("999", 1001.0));
    EXPECT_FALSE(table.use("0", 1001.0));
}

TEST(LoginTable, TotalOfAllTokensIsBounded) {
    LoginTable table;
    for (std::size_t n = 0; n < LoginTable::kLoginsMax + 10; ++n) {
        table.open(fmt::format("{}", n), fmt::format("{}", n), static_cast<double>(n) / 1000.0);
    }
    EXPECT_EQ(table.size(), LoginTable::kLoginsMax);
    EXPECT_FALSE(table.use("9", 10.0));
    EXPECT_TRUE(table.use("10", 10.0));
}

} // namespace
} // namespace scanloom::auth

#include "server/http/deadline.hpp"

#include <gtest/gtest.h>

namespace scanloom::http {
namespace {

using namespace std::chrono_literals;

TEST(PeerWait, IsTheTimeBeyondTheAllowance) {
    const PeerWait::Clock::time_point start{};
    PeerWait wait;
    EXPECT_FALSE(wait.behind(start));
    wait.begin(start);
    EXPECT_EQ(wait.behind(start + 5s), 5s);
    wait.allow(60.0);
    EXPECT_EQ(wait.behind(start + 5s), -55s) << "a fast sender is ahead";
    wait.end();
    EXPECT_FALSE(wait.behind(start + 5s));
    wait.begin(start + 6s);
    EXPECT_EQ(wait.behind(start + 7s), 1s) << "a new wait starts at 0";
}

} // namespace
} // namespace scanloom::http

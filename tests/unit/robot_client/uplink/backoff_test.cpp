#include "robot_client/uplink/backoff.hpp"

#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using namespace std::chrono_literals;

TEST(Backoff, DoublesToItsMaximumAndRestartsAfterReset) {
    Backoff backoff(1);
    std::chrono::milliseconds longest = 200ms;
    for (int i = 0; i < 12; ++i) {
        const auto wait = backoff.next();
        EXPECT_GE(wait, longest / 2);
        EXPECT_LE(wait, longest);
        longest = std::min(2 * longest, std::chrono::milliseconds(10s));
    }
    backoff.reset();
    EXPECT_LE(backoff.next(), 200ms);
}

TEST(Backoff, DifferentSeedsGiveDifferentDelays) {
    Backoff one(1);
    Backoff two(2);
    int same = 0;
    for (int i = 0; i < 10; ++i) same += one.next() == two.next();
    EXPECT_LT(same, 3);
}

} // namespace
} // namespace scanloom::robot

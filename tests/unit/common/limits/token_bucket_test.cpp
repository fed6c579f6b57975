#include "common/limits/token_bucket.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace scanloom::limits {
namespace {

TEST(TokenBucket, ReturnsTheTimeUntilTheMissingAmountHasFlowedIn) {
    TokenBucket bucket(1000.0, 1.0, 50.0);
    EXPECT_EQ(bucket.take(1000.0, 50.0), 0.0);
    EXPECT_DOUBLE_EQ(bucket.take(500.0, 50.0), 0.5);
    EXPECT_DOUBLE_EQ(bucket.take(250.0, 50.5), 0.25);
    EXPECT_EQ(bucket.take(250.0, 51.0), 0.0);
}

TEST(TokenBucket, WaitingCallerGetsTheRateAndOneBurst) {
    TokenBucket bucket(1000.0, 1.0, 0.0);
    double now = 0.0;
    double passed = 0.0;
    for (int n = 0; n < 1000; ++n) {
        now += bucket.take(64.0 * (1 + n % 40), now);
        passed += 64.0 * (1 + n % 40);
    }
    EXPECT_NEAR(passed, 1000.0 * (now + 1.0), 1.0);
}

TEST(TokenBucket, IdleTimeSavesAtMostTheBurst) {
    TokenBucket bucket(1000.0, 1.0, 0.0);
    EXPECT_EQ(bucket.take(1000.0, 3600.0), 0.0);
    EXPECT_DOUBLE_EQ(bucket.take(1000.0, 3600.0), 1.0);
}

TEST(TokenBucket, WithoutABurstEveryAmountCostsItsTime) {
    TokenBucket bucket(1e6, 0.0, 18'000.0);
    EXPECT_DOUBLE_EQ(bucket.take(500'000, 18'000.0), 0.5);
    EXPECT_DOUBLE_EQ(bucket.take(500'000, 18'000.0), 1.0) << "before the first wait was over";
    EXPECT_DOUBLE_EQ(bucket.take(1000, 21'600.0), 0.001);
}

TEST(TokenBucket, AnInfiniteRateNeverWaits) {
    TokenBucket bucket(std::numeric_limits<double>::infinity(), 1.0, 0.0);
    for (int n = 0; n < 3; ++n) EXPECT_EQ(bucket.take(1e12, 0.0), 0.0);
    bucket.set_rate(1000.0, 0.0);
    EXPECT_EQ(bucket.take(1000.0, 0.0), 0.0);
    EXPECT_DOUBLE_EQ(bucket.take(1000.0, 0.0), 1.0);
}

TEST(TokenBucket, StoppedOrBackwardClockAddsNothing) {
    TokenBucket bucket(10.0, 1.0, 5.0);
    EXPECT_EQ(bucket.take(10.0, 4.0), 0.0);
    EXPECT_DOUBLE_EQ(bucket.take(10.0, 4.0), 1.0);
}

} // namespace
} // namespace scanloom::limits

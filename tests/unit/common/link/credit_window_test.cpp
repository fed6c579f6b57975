#include "common/link/credit_window.hpp"

#include <gtest/gtest.h>

namespace scanloom::link {
namespace {

TEST(CreditWindow, BatchCountsUntilItsLastScanIsDurable) {
    CreditWindow window;
    window.reset(1000);
    window.sent(10, 300);
    window.sent(20, 400);
    EXPECT_EQ(window.available(), 300U);
    window.durable(9);
    EXPECT_EQ(window.under_way(), 700U);
    window.durable(10);
    EXPECT_EQ(window.under_way(), 400U);
    window.durable(25);
    EXPECT_EQ(window.available(), 1000U);
}

TEST(CreditWindow, LoweredCreditLeavesZero) {
    CreditWindow window;
    window.reset(1000);
    window.sent(1, 900);
    window.set_credit(100);
    EXPECT_EQ(window.available(), 0U);
}

TEST(CreditWindow, NewLinkHasNothingInFlight) {
    CreditWindow window;
    window.reset(1000);
    window.sent(1, 900);
    window.reset(500);
    EXPECT_EQ(window.available(), 500U);
    window.durable(1);
    EXPECT_EQ(window.under_way(), 0U);
}

} // namespace
} // namespace scanloom::link

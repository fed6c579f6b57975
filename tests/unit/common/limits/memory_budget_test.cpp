#include "common/limits/memory_budget.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace scanloom::limits {
namespace {

TEST(MemoryBudget, GrantsFreeMemoryOnlyInFull) {
    MemoryBudget budget(10);
    EXPECT_TRUE(budget.take(7));
    EXPECT_FALSE(budget.take(4));
    EXPECT_EQ(budget.free(), 3);
    EXPECT_TRUE(budget.take(3));
    EXPECT_TRUE(budget.take(0));
    EXPECT_EQ(budget.used(), 10);
    budget.give_back(10);
    EXPECT_EQ(budget.free(), budget.total());
}

TEST(MemoryBudget, RefusesWhileOverdrawn) {
    MemoryBudget budget(2);
    budget.take_anyway(5);
    EXPECT_EQ(budget.free(), -3);
    EXPECT_FALSE(budget.take(1));
    budget.give_back(4);
    EXPECT_TRUE(budget.take(1));
}

TEST(MemoryShare, TakesFromAllBudgetsOrFromNone) {
    const auto large = std::make_shared<MemoryBudget>(10);
    const auto small = std::make_shared<MemoryBudget>(4);
    {
        MemoryShare share({large, small});
        EXPECT_EQ(share.most(), 4);
        EXPECT_TRUE(share.take(3));
        EXPECT_FALSE(share.take(2));
        EXPECT_EQ(large->free(), 7) << "the share of the large budget is returned";
        EXPECT_EQ(share.free(), 1);
        share.take_anyway(2);
        EXPECT_EQ(share.free(), 0) << "not negative";
        EXPECT_TRUE(share.take(0)) << "although a budget is exceeded";
        share.give_back(1);
        EXPECT_EQ(small->free(), 0);
    }
    EXPECT_EQ(large->free(), 10);
    EXPECT_EQ(small->free(), 4);
}

} // namespace
} // namespace scanloom::limits

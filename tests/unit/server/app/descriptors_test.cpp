#include "server/app/descriptors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace scanloom::app {
namespace {

using testing::HasSubstr;

TEST(Descriptors, AllAreServedWhereThereAreEnough) {
    for (const std::uint64_t many : {std::uint64_t{20'000}, std::numeric_limits<std::uint64_t>::max()}) {
        EXPECT_EQ(limits_within(many), ConnectionLimits{});
        EXPECT_EQ(shortage(many), "");
    }
}

TEST(Descriptors, TheStoreKeepsItsShareOfFew) {
    for (std::uint64_t few = 500; few < 12'000; few += 7) {
        const auto limits = limits_within(few);
        EXPECT_LE(limits.robots + 2 * limits.greeting + limits.http + 350, few) << few;
        EXPECT_GE(limits.robots, limits.http) << few;
    }
}

TEST(Descriptors, SomeAreServedInAnyCase) {
    for (const std::uint64_t none : {0, 64, 350, 420}) {
        const auto limits = limits_within(none);
        EXPECT_GT(limits.robots, 0U);
        EXPECT_GT(limits.greeting, 0U);
        EXPECT_GT(limits.http, 0U);
    }
}

TEST(Descriptors, AShortageIsSaidWithItsRemedy) {
    EXPECT_THAT(shortage(1024), AllOf(HasSubstr("1024 file descriptors"), HasSubstr("ulimit -n")));
}

} // namespace
} // namespace scanloom::app

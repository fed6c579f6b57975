#include "load/core/figures.hpp"

#include <gtest/gtest.h>

namespace scanloom::load {
namespace {

const ServerUse kBefore{{10.0, 1e6}, 1'700'000'000.25};

TEST(UsedBetween, IsTheDifferenceForOneProcess) {
    const auto used = used_between(kBefore, ServerUse{{12.5, 2e6}, kBefore.started});
    ASSERT_TRUE(used);
    EXPECT_EQ(used->cpu_seconds, 2.5);
    EXPECT_EQ(used->resident_bytes, 2e6);
}

TEST(UsedBetween, CpuTimeOfAnotherProcessIsUnknown) {
    for (const double cpu_seconds : {0.5, 12.5}) {
        const auto used = used_between(kBefore, ServerUse{{cpu_seconds, 2e6}, kBefore.started + 60.0});
        ASSERT_TRUE(used);
        EXPECT_EQ(used->cpu_seconds, std::nullopt) << cpu_seconds;
        EXPECT_EQ(used->resident_bytes, 2e6);
    }
}

TEST(UsedBetween, DecreasingCpuTimeIsUnknownWithoutStartTime) {
    EXPECT_EQ(used_between(ServerUse{{10.0, 1e6}}, ServerUse{{9.0, 1e6}})->cpu_seconds, std::nullopt);
    EXPECT_EQ(used_between(ServerUse{{10.0, 1e6}}, ServerUse{{11.0, 1e6}})->cpu_seconds, 1.0);
}

TEST(UsedBetween, IsEmptyWithoutBothMeasurements) {
    EXPECT_FALSE(used_between(kBefore, std::nullopt));
    EXPECT_FALSE(used_between(std::nullopt, kBefore));
}

} // namespace
} // namespace scanloom::load

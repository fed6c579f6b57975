#include "server/app/resource_limits.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace scanloom::app {
namespace {

using testing::HasSubstr;

TEST(Descriptors, AllowAllConnectionsIfSufficient) {
    for (const std::uint64_t many : {std::uint64_t{20'000}, std::numeric_limits<std::uint64_t>::max()}) {
        EXPECT_EQ(limits_within(many), ConnectionLimits{});
        EXPECT_EQ(shortage(many), "");
    }
}

TEST(Descriptors, ReserveAShareForTheStore) {
    for (std::uint64_t few = 500; few < 12'000; few += 7) {
        const auto limits = limits_within(few);
        EXPECT_LE(limits.robots + 2 * limits.greeting + limits.http + 350, few) << few;
        EXPECT_GE(limits.robots, limits.http) << few;
    }
}

TEST(Descriptors, AlwaysAllowSomeConnections) {
    for (const std::uint64_t none : {0, 64, 350, 420}) {
        const auto limits = limits_within(none);
        EXPECT_GT(limits.robots, 0U);
        EXPECT_GT(limits.greeting, 0U);
        EXPECT_GT(limits.http, 0U);
    }
}

TEST(Descriptors, ShortageNamesTheRemedy) {
    EXPECT_THAT(shortage(1024), AllOf(HasSubstr("1024 file descriptors"), HasSubstr("ulimit -n")));
}

using testing::HasSubstr;

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;
constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

ServerOptions options_with(const MapMemory& memory) {
    ServerOptions options;
    options.map_memory_bytes = memory.maps;
    options.replay_memory_bytes = memory.replay_jobs;
    return options;
}

TEST(DefaultMapMemory, IsHalfAndAQuarterOfTheMemory) {
    EXPECT_EQ(default_map_memory({1024 * kMib, kNoLimit}), (MapMemory{512 * kMib, 256 * kMib}));
    EXPECT_EQ(default_map_memory({100 * kMib, kNoLimit}), (MapMemory{64 * kMib, 64 * kMib}));
}

TEST(DefaultMapMemory, FitsIntoALimitedAddressSpace) {
    for (const std::uint64_t mib : {700, 879, 1172, 4000, 40'000}) {
        const MemoryLimit limit{8192 * kMib, mib * kMib};
        EXPECT_TRUE(check_address_space(options_with(default_map_memory(limit)), limit)) << mib;
    }
}

TEST(CheckAddressSpace, ReportsLimitAndRequiredSize) {
    for (const std::uint64_t mib : {100, 390, 500, 600, 640}) {
        const MemoryLimit limit{8192 * kMib, mib * kMib};
        const auto fits = check_address_space(options_with(default_map_memory(limit)), limit);
        ASSERT_FALSE(fits) << mib;
        const auto& message = fits.error().message;
        EXPECT_THAT(message, HasSubstr(fmt::format("limited to {} MiB", mib)));
        const auto kibibytes = std::stoull(message.substr(message.find("ulimit -v ") + 10));
        const MemoryLimit advised{8192 * kMib, kibibytes * 1024};
        EXPECT_TRUE(check_address_space(options_with(default_map_memory(advised)), advised)) << message;
        EXPECT_LT(kibibytes, 700'000U) << "no more than it takes";
    }
}

} // namespace
} // namespace scanloom::app

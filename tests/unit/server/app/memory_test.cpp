#include "server/app/memory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace scanloom::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint64_t kMib = std::uint64_t{1} << 20;
constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

ServerOptions options_with(const MapMemory& memory) {
    ServerOptions options;
    options.map_memory_bytes = memory.maps;
    options.weave_memory_bytes = memory.weaves;
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

TEST(CheckAddressSpace, ReportsLimitAndNeededAddressSpace) {
    const MemoryLimit limit{8192 * kMib, 390 * kMib};
    const auto fits = check_address_space(options_with(default_map_memory(limit)), limit);
    EXPECT_THAT(fits.error().message,
                AllOf(HasSubstr("limited to 390 MiB"), HasSubstr("needs 643"), HasSubstr("ulimit -v 658432")));
}

} // namespace
} // namespace scanloom::app

#include "server/sessions/session_registry.hpp"
#include "tests/support/memory_scan_log.hpp"

#include <boost/asio/thread_pool.hpp>
#include <gtest/gtest.h>

#include <fstream>

namespace scanloom::sessions {
namespace {

std::size_t resident_bytes() {
    std::size_t all = 0;
    std::size_t resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * 4096;
}

TEST(ImportedMapMemory, IsReleasedByRemoval) {
    store::MemoryScanLog log;
    boost::asio::thread_pool pool(1);
    SessionRegistry registry(log, {pool.get_executor(), [] { return 1.0; }});
    constexpr std::uint32_t kSide = 4096; // 64 chunks of 20 kB per side
    const auto map = [&](double y) {
        return MapPatch{0.1, 0.0, y, kSide, std::vector<MapCell>(std::size_t{kSide} * 512, MapCell::kFree)};
    };
    std::vector<MapPatch> patches;
    for (int n = 0; n < 8; ++n) patches.push_back(map(51.2 * n));
    ASSERT_TRUE(registry.import_map("large", {.cell_size = 0.1}, patches));
    // This session follows the large map in the heap, so the large map is not at the heap's end.
    ASSERT_TRUE(registry.import_map("small", {.cell_size = 0.1}, {{0.1, 0.0, 0.0, 1, {MapCell::kFree}}}));
    const std::size_t with_it = resident_bytes();
    ASSERT_TRUE(registry.remove("large"));
    registry.drain();
    pool.join();
    EXPECT_LT(resident_bytes() + 50'000'000, with_it);
}

} // namespace
} // namespace scanloom::sessions

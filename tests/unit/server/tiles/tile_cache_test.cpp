#include "server/tiles/tile_cache.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <latch>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace scanloom::tiles {
namespace {

TilePlace place(std::uint32_t x, std::string maps = "maps") {
    return {std::move(maps), mapping::Layer::kOccupancy, {9, x, 0}, TileFormat::kPng};
}

KeptTile tile(std::size_t size, Revision revision = 1) {
    return {std::make_shared<const Bytes>(size, std::uint8_t{7}), revision};
}

TEST(TileCache, DistinguishesPlacesFormatsLayersMapsAndRevisions) {
    TileCache cache(1'000'000);
    cache.keep(place(1), tile(10));
    ASSERT_NE(cache.find(place(1), 1), nullptr);
    EXPECT_EQ(cache.find(place(1), 2), nullptr);
    EXPECT_EQ(cache.find(place(2), 1), nullptr);
    EXPECT_EQ(cache.find(place(1, "others"), 1), nullptr);
    auto other = place(1);
    other.format = TileFormat::kCodes;
    EXPECT_EQ(cache.find(other, 1), nullptr);
    other = place(1);
    other.layer = mapping::Layer::kHimm;
    EXPECT_EQ(cache.find(other, 1), nullptr);
    EXPECT_EQ(cache.stats().hits, 1U);
}

TEST(TileCache, EvictsTheLeastRecentlyUsed) {
    TileCache cache(10'000);
    for (std::uint32_t x = 0; x < 3; ++x) cache.keep(place(x), tile(2'500));
    ASSERT_NE(cache.find(place(0), 1), nullptr); // so that 1 was used longest ago
    cache.keep(place(3), tile(2'500));
    EXPECT_NE(cache.find(place(0), 1), nullptr);
    EXPECT_EQ(cache.find(place(1), 1), nullptr);
    EXPECT_NE(cache.find(place(2), 1), nullptr);
    EXPECT_NE(cache.find(place(3), 1), nullptr);
}

TEST(TileCache, NeverExceedsItsMemory) {
    constexpr std::size_t kMax = 100'000;
    TileCache cache(kMax);
    std::mt19937 random(3);
    std::size_t tiles_max = 0;
    for (Revision n = 1; n <= 5'000; ++n) {
        cache.keep(place(static_cast<std::uint32_t>(random() % 300)), tile(random() % 4'000, n));
        ASSERT_LE(cache.stats().bytes, kMax);
        tiles_max = std::max(tiles_max, cache.stats().tiles);
    }
    EXPECT_GT(tiles_max, 20U);
    cache.keep(place(0), tile(kMax, 9'999));
    EXPECT_EQ(cache.find(place(0), 9'999), nullptr) << "larger than all of it";
    cache.forget("maps");
    EXPECT_EQ(cache.stats().bytes, 0U);
    EXPECT_EQ(cache.stats().tiles, 0U);
}

TEST(TileCache, KeepsTheNewestRevision) {
    TileCache cache(1'000'000);
    cache.keep(place(1), tile(10, 5));
    cache.keep(place(1), tile(11, 8));
    EXPECT_EQ(cache.find(place(1), 5), nullptr);
    cache.keep(place(1), tile(12, 6));
    EXPECT_NE(cache.find(place(1), 8), nullptr);
    EXPECT_EQ(cache.newest(place(1)).revision, 8U);
    EXPECT_EQ(cache.stats().tiles, 1U);
}

TEST(TileCache, MakesATileOnceForConcurrentRequests) {
    constexpr int kAsking = 20;
    TileCache cache(1'000'000);
    std::atomic<int> made = 0;
    std::latch all_ask(kAsking);
    std::vector<SharedBytes> got(kAsking);
    std::vector<std::thread> threads;
    for (auto& each : got) {
        threads.emplace_back([&] {
            all_ask.arrive_and_wait();
            each = cache.get(place(1), 1, [&] {
                ++made;
                return tile(10);
            });
        });
    }
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(made, 1);
    for (const auto& each : got) EXPECT_EQ(each, got.front());
    EXPECT_EQ(cache.stats().misses, 1U);
    EXPECT_EQ(cache.stats().hits, 19U);
}

TEST(TileCache, PassesTheExceptionToAllWaitingRequests) {
    TileCache cache(1'000'000);
    std::promise<void> is_waited_for;
    std::promise<void> may_fail;
    const auto fail = [&]() -> KeptTile {
        is_waited_for.set_value();
        may_fail.get_future().wait();
        throw std::runtime_error("out of paint");
    };
    auto first = std::async(std::launch::async, [&] { return cache.get(place(1), 1, fail); });
    is_waited_for.get_future().wait();
    auto second = std::async(std::launch::async, [&] { return cache.get(place(1), 1, [] { return tile(10); }); });
    while (cache.stats().hits == 0) std::this_thread::yield(); // until the second waits
    may_fail.set_value();
    EXPECT_THROW(first.get(), std::runtime_error);
    EXPECT_THROW(second.get(), std::runtime_error);
    EXPECT_NE(cache.get(place(1), 1, [] { return tile(10); }), nullptr) << "the next tries again";
}

TEST(TileCache, ForgetsTilesOfMapsAndOfTheirReplayJobs) {
    TileCache cache(1'000'000);
    for (const auto* maps : {"a-1", "a-1-0123", "a-12", "b"}) cache.keep(place(1, maps), tile(10));
    cache.forget("a-1");
    EXPECT_EQ(cache.find(place(1, "a-1"), 1), nullptr);
    EXPECT_EQ(cache.find(place(1, "a-1-0123"), 1), nullptr);
    EXPECT_NE(cache.find(place(1, "a-12"), 1), nullptr);
    EXPECT_NE(cache.find(place(1, "b"), 1), nullptr);
}

TEST(TileCache, DoesNotCacheATileForgottenWhileMade) {
    TileCache cache(1'000'000);
    const auto bytes = cache.get(place(1), 1, [&] {
        cache.forget("maps");
        return tile(10);
    });
    EXPECT_NE(bytes, nullptr);
    EXPECT_EQ(cache.find(place(1), 1), nullptr);
}

} // namespace
} // namespace scanloom::tiles

#include "server/tiles/tile_cache.hpp"

#include "tests/support/failing_allocation.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace scanloom::tiles {
namespace {

using testing_support::allocations_left;

const TilePlace kPlace{"the-tag-of-maps-that-is-too-long-for-no-memory", mapping::Layer::kOccupancy, {9, 1, 0}};

KeptTile tile(Revision revision) { return {std::make_shared<const Bytes>(10, std::uint8_t{7}), revision}; }

/// The tile as `get` gives it, with only so many allocations after it was made. @return whether these sufficed
bool get_with(TileCache& cache, Revision revision, int allocations) {
    const auto got = cache.get(kPlace, revision, [&] {
        auto made = tile(revision);
        allocations_left = allocations;
        return made;
    });
    EXPECT_NE(got, nullptr);
    const bool sufficed = allocations_left.has_value();
    allocations_left.reset();
    return sufficed;
}

TEST(TileCacheMemory, ReturnsTileThatCannotBeCachedAndMakesItAgain) {
    int allocations = 0;
    for (bool is_kept = false; !is_kept; ++allocations) {
        TileCache cache(1'000'000);
        cache.keep(kPlace, tile(1));
        is_kept = get_with(cache, 2, allocations);
        ASSERT_EQ(cache.find(kPlace, 2) != nullptr, is_kept) << allocations;
        ASSERT_EQ(cache.stats().tiles, is_kept ? 1U : 0U) << allocations;
        ASSERT_EQ(cache.stats().bytes > 0, is_kept) << allocations;
        bool is_made_again = false;
        ASSERT_NE(cache.get(kPlace, 2, [&] { return is_made_again = true, tile(2); }), nullptr);
        ASSERT_EQ(is_made_again, !is_kept) << allocations;
        cache.forget(kPlace.maps);
        ASSERT_EQ(cache.stats().bytes, 0U) << allocations;
    }
    EXPECT_GT(allocations, 3) << "the entry, its place, and the name in it";
}

} // namespace
} // namespace scanloom::tiles

#include "server/tiles/changes.hpp"

#include "server/tiles/tile_version.hpp"
#include "tests/support/random_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

namespace scanloom::tiles {
namespace {

using mapping::Layer;
using ChunkRevisions = std::map<grid::ChunkKey, Revision>;

/// In the order promised: falling zoom, then y, then x.
using Touched = std::map<std::tuple<int, int, int>, Revision>; // (-zoom, y, x)

Touched brute_force(const ChunkRevisions& chunks, Revision since) {
    Touched touched;
    for (const auto& [key, revision] : chunks) {
        const int i = key.ci * 64;
        const int j = key.cj * 64 + 63;
        if (revision <= since || i < -65536 || i > 65535 || j < -65536 || j > 65535) continue;
        for (int zoom = 0; zoom <= 9; ++zoom) {
            const int side = 256 << (9 - zoom);
            auto& newest = touched[{-zoom, (65535 - j) / side, (i + 65536) / side}];
            newest = std::max(newest, revision);
        }
    }
    return touched;
}

TEST(Changes, EqualBruteForceAfterAnyRevision) {
    std::mt19937 random(5);
    auto keys = testing_support::scattered_chunks(random);
    std::shuffle(keys.begin(), keys.end(), random);
    mapping::LaserLayers layers{mapping::MapConfig{}};
    const auto change = [&](grid::ChunkKey key, Revision at) { layers.restore(key, at).occupancy.fill(0); };
    ChunkRevisions revisions;
    Revision revision = 0;
    for (const auto& key : keys) change(key, revisions[key] = ++revision);
    for (int n = 0; n < 50; ++n) {
        const auto& key = keys[random() % keys.size()];
        change(key, revisions[key] = ++revision);
    }
    const mapping::Snapshot snapshot{.revision = revision, .laser = layers.snapshot()};

    for (const Revision since : {Revision{0}, Revision{1}, revision / 2, revision - 3, revision - 1}) {
        const auto expected = brute_force(revisions, since);
        const auto changed = changed_tiles(snapshot, Layer::kOccupancy, since);
        ASSERT_EQ(changed.size(), expected.size()) << "since " << since;
        std::size_t n = 0;
        for (const auto& [at, newest] : expected) {
            const auto [minus_zoom, y, x] = at;
            const TileKey key{static_cast<std::uint32_t>(-minus_zoom), static_cast<std::uint32_t>(x),
                              static_cast<std::uint32_t>(y)};
            EXPECT_EQ(changed[n], (ChangedTile{key, newest})) << "entry " << n << " since " << since;
            EXPECT_EQ(newest, tile_revision(snapshot, Layer::kOccupancy, key));
            ++n;
        }
    }
    EXPECT_THAT(changed_tiles(snapshot, Layer::kOccupancy, revision), testing::IsEmpty());
    EXPECT_THAT(changed_tiles(snapshot, Layer::kOccupancy, revision + 1), testing::IsEmpty());
    EXPECT_THAT(changed_tiles(mapping::Snapshot{}, Layer::kOccupancy, 0), testing::IsEmpty());
}

} // namespace
} // namespace scanloom::tiles

#include "server/tiles/tile_maker.hpp"

#include "server/tiles/tile.hpp"
#include "tests/support/random_layers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace scanloom::tiles {
namespace {

using mapping::Layer;
using testing_support::RandomLayers;

class TileMakerOf : public testing::TestWithParam<Layer> {};

INSTANTIATE_TEST_SUITE_P(AnyLayer, TileMakerOf, testing::ValuesIn(mapping::kLayers),
                         [](const auto& tried) { return std::string(mapping::name_of(tried.param)); });

const auto kOrigin = std::make_shared<const int>(0);

SharedBytes made(TileMaker& maker, const mapping::Snapshot& snapshot, const TilePlace& place,
                 const std::shared_ptr<const void>& origin = kOrigin) {
    return maker.make({snapshot, origin}, place, tile_revision(snapshot, place.layer, place.key));
}

TEST_P(TileMakerOf, IncrementalTilesEqualNewlyDrawnTiles) {
    std::mt19937 random(7);
    auto keys = testing_support::scattered_chunks(random);
    RandomLayers layers;
    TileMaker maker;
    std::vector<TileKey> tiles;
    for (std::uint32_t zoom = 0; zoom <= kZoomNative; ++zoom) {
        for (const auto cell : {grid::Cell{0, 0}, {-1, -1}, {-300, 70}, {65535, -65536}}) {
            tiles.push_back(tile_of(cell, zoom));
        }
    }
    for (Revision revision = 1; revision <= 25; ++revision) {
        std::shuffle(keys.begin(), keys.end(), random);
        const auto changed = revision == 1 ? keys.size() / 2 : 1 + random() % 4;
        layers.fill({keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(changed)}, random, revision);
        const auto snapshot = layers.snapshot(revision);
        for (const auto& key : tiles) {
            if (revision > 1 && random() % 3 == 0) continue; // some are looked at now and then
            const auto expected = tile_codes(snapshot, GetParam(), key);
            ASSERT_TRUE(*made(maker, snapshot, {"maps", GetParam(), key, TileFormat::kCodes}) == *expected)
                << revision << ": " << key.zoom << "/" << key.x << "/" << key.y;
            ASSERT_TRUE(*made(maker, snapshot, {"maps", GetParam(), key, TileFormat::kPng}) ==
                        *tile_png(expected, GetParam()));
        }
    }
}

/// A map of one chunk, with all cells of one value.
mapping::Snapshot uniform(mapping::LogOdds value, Revision revision) {
    mapping::LaserLayers layers{mapping::MapConfig{}};
    layers.restore({0, 0}, revision).occupancy.fill(value);
    return {.revision = revision, .laser = layers.snapshot()};
}

const TilePlace kWhole{"maps", Layer::kOccupancy, {0, 0, 0}, TileFormat::kPng};

TEST(TileMaker, MakesEachRevisionOfATileOnce) {
    TileMaker maker;
    const auto first = uniform(-3000, 1);
    EXPECT_EQ(maker.find(kWhole, 1), nullptr);
    const auto tile = made(maker, first, kWhole);
    EXPECT_EQ(maker.find(kWhole, 1), tile);
    EXPECT_EQ(made(maker, first, kWhole), tile);
    EXPECT_EQ(maker.find(kWhole, 2), nullptr);
    EXPECT_NE(*made(maker, uniform(3000, 2), kWhole), *tile);
    EXPECT_EQ(maker.stats().misses, 2U);
    EXPECT_EQ(maker.stats().hits, 2U);
}

TEST(TileMaker, DrawsAnOlderMapWithoutNewerDrawings) {
    TileMaker maker;
    const auto newer = made(maker, uniform(3000, 9), kWhole);
    EXPECT_EQ(*made(maker, uniform(-3000, 4), kWhole), *tile_png(uniform(-3000, 4), Layer::kOccupancy, {0, 0, 0}));
    EXPECT_EQ(maker.find(kWhole, 9), newer) << "which stays";
}

TEST(TileMaker, DrawsRecomputedMapsWithoutEarlierDrawings) {
    TileMaker maker;
    mapping::LaserLayers layers{mapping::MapConfig{}};
    layers.restore({0, 0}, 1).occupancy.fill(-3000);
    layers.restore({0, 8}, 5).occupancy.fill(-3000);
    const mapping::Snapshot again{.revision = 5, .laser = layers.snapshot()};
    static_cast<void>(made(maker, uniform(3000, 2), kWhole)); // reports no change of this chunk since revision 2
    const auto tile = made(maker, again, kWhole, std::make_shared<const int>(0));
    EXPECT_EQ(*tile, *tile_png(again, Layer::kOccupancy, {0, 0, 0}));
}

TEST(TileMaker, ReturnsUntouchedTilesWithoutMakingThem) {
    TileMaker maker;
    EXPECT_EQ(maker.find(kWhole, 0), tile_png(mapping::Snapshot{}, Layer::kOccupancy, {0, 0, 0}));
    EXPECT_EQ(maker.stats().tiles, 0U);
}

bool is_quick(TileMaker& maker, const mapping::Snapshot& snapshot, const TilePlace& place,
              const std::shared_ptr<const void>& origin = kOrigin) {
    return maker.is_quick(origin, place, tile_revision(snapshot, place.layer, place.key));
}

TEST(TileMaker, ReadsAWholeMapOnce) {
    TileMaker maker;
    const auto map = uniform(3000, 1);
    EXPECT_FALSE(is_quick(maker, map, kWhole));
    EXPECT_TRUE(is_quick(maker, map, {"maps", Layer::kOccupancy, {5, 16, 15}, TileFormat::kPng}));
    static_cast<void>(made(maker, map, kWhole));
    EXPECT_TRUE(is_quick(maker, uniform(-3000, 2), kWhole));
    maker.forget("maps");
    EXPECT_FALSE(is_quick(maker, uniform(-3000, 2), kWhole));
}

TEST(TileMaker, ReadsAWholeMapAgainWithoutUsableDrawing) {
    TileMaker maker;
    static_cast<void>(made(maker, uniform(3000, 5), kWhole));
    EXPECT_TRUE(is_quick(maker, uniform(-3000, 6), kWhole));
    EXPECT_FALSE(is_quick(maker, uniform(-3000, 4), kWhole)) << "it is of a later map";
    EXPECT_FALSE(is_quick(maker, uniform(-3000, 6), kWhole, std::make_shared<const int>(0))) << "it is of other maps";
}

} // namespace
} // namespace scanloom::tiles

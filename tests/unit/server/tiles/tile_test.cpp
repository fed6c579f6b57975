#include "server/tiles/tile.hpp"

#include "server/tiles/occupancy_percent.hpp"
#include "server/tiles/tile_version.hpp"
#include "tests/support/random_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <cmath>
#include <optional>
#include <tuple>

namespace scanloom::tiles {
namespace {

using mapping::Layer;
using mapping::LogOdds;
using testing_support::HandMadeMap;
using testing_support::random_map;

/// The rule for pixels that show many cells, word for word.
class PixelOracle {
public:
    void add(int percent) {
        if (percent == 255) return;
        if (percent > 50 && percent > furthest_above_.value_or(50)) furthest_above_ = percent;
        if (percent < lowest_known_.value_or(101)) lowest_known_ = percent;
    }
    [[nodiscard]] int percent() const { return furthest_above_.value_or(lowest_known_.value_or(255)); }

private:
    std::optional<int> furthest_above_;
    std::optional<int> lowest_known_;
};

using TilePixels = std::map<int, PixelOracle>; // by 256 py + px
using Pyramid = std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, TilePixels>;

/// Puts every cell where the contract says that it is seen, zoom by zoom.
Pyramid oracle_of(const HandMadeMap& map) {
    Pyramid pyramid;
    for (const auto& [key, cells] : map.chunks()) {
        for (int n = 0; n < 4096; ++n) {
            const int i = key.ci * 64 + n % 64;
            const int j = key.cj * 64 + n / 64;
            if (i < -65536 || i > 65535 || j < -65536 || j > 65535) continue;
            const LogOdds l = cells[static_cast<std::size_t>(n)];
            const int percent =
                l == mapping::kUnknownLogOdds ? 255 : static_cast<int>(std::lround(100 / (1 + std::exp(-l / 2048.0))));
            for (std::uint32_t zoom = 0; zoom <= 9; ++zoom) {
                const int column = (i + 65536) >> (9 - zoom);
                const int row = (65535 - j) >> (9 - zoom);
                pyramid[{zoom, column / 256, row / 256}][row % 256 * 256 + column % 256].add(percent);
            }
        }
    }
    return pyramid;
}

TEST(Tile, EqualsBruteForceAtEveryZoom) {
    const auto map = random_map(11);
    const auto snapshot = map.snapshot();
    const auto pyramid = oracle_of(map);
    ASSERT_GT(pyramid.size(), 200U);
    for (const auto& [at, pixels] : pyramid) {
        const auto [zoom, x, y] = at;
        std::vector<std::uint8_t> expected(65536, 255);
        for (const auto& [pixel, oracle] : pixels) {
            expected[static_cast<std::size_t>(pixel)] = static_cast<std::uint8_t>(oracle.percent());
        }
        ASSERT_TRUE(*tile_codes(snapshot, Layer::kOccupancy, {zoom, x, y}) == expected) << zoom << "/" << x << "/" << y;
    }
}

Bytes composed_of_children(const mapping::Snapshot& snapshot, TileKey key) {
    Bytes composed(65536);
    for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
        const std::uint32_t right = quarter % 2;
        const std::uint32_t below = quarter / 2;
        const auto child =
            tile_codes(snapshot, Layer::kOccupancy, {key.zoom + 1, 2 * key.x + right, 2 * key.y + below});
        for (std::uint32_t n = 0; n < 128 * 128; ++n) {
            const std::uint32_t column = n % 128;
            const std::uint32_t row = n / 128;
            PixelOracle oracle;
            for (const std::uint32_t at : {0U, 1U, 256U, 257U}) oracle.add((*child)[512 * row + 2 * column + at]);
            composed[256 * (128 * below + row) + 128 * right + column] = static_cast<Percent>(oracle.percent());
        }
    }
    return composed;
}

TEST(Tile, IsTheSameMadeFromItsFourChildren) {
    const auto snapshot = random_map(12).snapshot();
    for (std::uint32_t zoom = 0; zoom < 9; ++zoom) {
        for (const auto cell : {grid::Cell{0, 0}, {-1, -1}, {-1, 0}, {65535, 65535}, {-65536, -65536}}) {
            const auto key = tile_of(cell, zoom);
            ASSERT_TRUE(*tile_codes(snapshot, Layer::kOccupancy, key) == composed_of_children(snapshot, key))
                << zoom << "/" << key.x << "/" << key.y;
        }
    }
}

TEST(Tile, AOneCellWallSurvivesEveryZoom) {
    HandMadeMap map;
    for (std::int32_t j = -700; j < 700; ++j) {
        for (std::int32_t i = -100; i < 100; ++i) map.set({i, j}, i == 37 ? LogOdds{3000} : LogOdds{-14000});
    }
    const auto snapshot = map.snapshot();
    const Percent wall = percent_table()[3000];
    for (std::uint32_t zoom = 0; zoom <= 9; ++zoom) {
        std::map<std::uint32_t, SharedBytes> column_of_tiles;
        for (std::int32_t j = -700; j < 700; ++j) {
            const auto key = tile_of({37, j}, zoom);
            auto& tile = column_of_tiles[key.y];
            if (!tile) tile = tile_codes(snapshot, Layer::kOccupancy, key);
            const auto cells = cells_of(key);
            const auto px = (37 - cells.i_begin) >> (9 - zoom);
            const auto py = (cells.j_end - 1 - j) >> (9 - zoom);
            ASSERT_EQ((*tile)[static_cast<std::size_t>(py * 256 + px)], wall) << "zoom " << zoom << ", row " << j;
        }
    }
}

TEST(Tile, RowZeroIsTheTop) {
    HandMadeMap map;
    map.set({0, 255}, 14000);
    map.set({255, 0}, -14000);
    const auto tile = tile_codes(map.snapshot(), Layer::kOccupancy, {9, 256, 255});
    EXPECT_EQ(tile->at(0), 100);
    EXPECT_EQ(tile->at(65535), 0);
    EXPECT_EQ(tile->at(255), 255);
    EXPECT_EQ(tile->at(65280), 255);
}

TEST(Tile, NeverTouchedTilesAreOneSharedUniformTile) {
    HandMadeMap map;
    map.set({65536, 0}, 14000); // just outside
    map.set({0, -65537}, 14000);
    const auto snapshot = map.snapshot();
    const auto tile = tile_codes(snapshot, Layer::kOccupancy, {0, 0, 0});
    EXPECT_THAT(*tile, testing::AllOf(testing::SizeIs(65536), testing::Each(255)));
    EXPECT_EQ(tile, tile_codes(snapshot, Layer::kOccupancy, {9, 511, 255}));
    EXPECT_EQ(tile_png(snapshot, Layer::kOccupancy, {0, 0, 0}),
              tile_png(mapping::Snapshot{}, Layer::kOccupancy, {9, 1, 2}));
}

TEST(Tile, ThePngIsEightBitGreyOfTheSamePixels) {
    const auto snapshot = random_map(13).snapshot();
    for (const TileKey key : {TileKey{9, 256, 255}, TileKey{7, 63, 64}, TileKey{0, 0, 0}, TileKey{9, 0, 5}}) {
        const auto tile = tile_codes(snapshot, Layer::kOccupancy, key);
        const auto png = tile_png(snapshot, Layer::kOccupancy, key);
        ASSERT_GT(png->size(), 26U);
        EXPECT_EQ(png->at(24), 8) << "bits a pixel";
        EXPECT_EQ(png->at(25), 0) << "grey, no alpha";
        const cv::Mat image = cv::imdecode(*png, cv::IMREAD_UNCHANGED);
        ASSERT_EQ(image.type(), CV_8UC1);
        ASSERT_EQ(image.size(), cv::Size(256, 256));
        for (std::size_t n = 0; n < tile->size(); ++n) ASSERT_EQ(image.data[n], grey_of((*tile)[n])) << n;
    }
}

TEST(TileVersion, ChangesWithTheTileAndNotWithOtherPlaces) {
    mapping::LaserLayers layers{mapping::MapConfig{}};
    const auto snapshot_at = [&](Revision revision) {
        return mapping::Snapshot{.revision = revision, .laser = layers.snapshot()};
    };
    const auto change = [&](grid::ChunkKey key, Revision revision) {
        layers.restore(key, revision).occupancy.fill(-3000);
    };
    change({0, 0}, 1);
    const auto first = snapshot_at(1);
    change({0, 4}, 2); // the next tile to the right
    const auto second = snapshot_at(2);
    change({3, 3}, 3); // the same tile's other corner
    const auto third = snapshot_at(3);

    const TileKey here{9, 256, 255};
    const TileKey right{9, 257, 255};
    const TileKey both{8, 128, 127};
    const auto revisions = [&](const mapping::Snapshot& snapshot) {
        return std::tuple{tile_revision(snapshot, Layer::kOccupancy, here),
                          tile_revision(snapshot, Layer::kOccupancy, right),
                          tile_revision(snapshot, Layer::kOccupancy, both)};
    };
    EXPECT_EQ(revisions(mapping::Snapshot{}), (std::tuple{0U, 0U, 0U}));
    EXPECT_EQ(revisions(first), (std::tuple{1U, 0U, 1U}));
    EXPECT_EQ(revisions(second), (std::tuple{1U, 2U, 2U}));
    EXPECT_EQ(revisions(third), (std::tuple{3U, 2U, 3U}));
    EXPECT_EQ(tile_revision(third, Layer::kOccupancy, {0, 0, 0}), 3U);
}

TEST(TileVersion, EntityTagsAreStrongAndTellEverythingApart) {
    const TileKey key{9, 256, 255};
    const auto etag = etag_of("000000000000002a", "occupancy", key, 7);
    EXPECT_THAT(etag, testing::AllOf(testing::StartsWith("\""), testing::EndsWith("\"")));
    EXPECT_EQ(etag.find('"', 1), etag.size() - 1);
    EXPECT_EQ(etag, etag_of("000000000000002a", "occupancy", key, 7));
    EXPECT_NE(etag, etag_of("000000000000002b", "occupancy", key, 7)) << "a session made anew";
    EXPECT_NE(etag, etag_of("000000000000002a", "himm", key, 7));
    EXPECT_NE(etag, etag_of("000000000000002a", "occupancy", {9, 255, 256}, 7));
    EXPECT_NE(etag, etag_of("000000000000002a", "occupancy", key, 8));
}

} // namespace
} // namespace scanloom::tiles

#include "server/tiles/tile.hpp"

#include "server/tiles/layer_style.hpp"
#include "tests/support/pixel_oracle.hpp"
#include "tests/support/random_layers.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/restored.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

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
    const auto all = changed_tiles(snapshot, Layer::kOccupancy, revision / 2);
    const auto native = changed_native_tiles(snapshot, Layer::kOccupancy, revision / 2);
    ASSERT_LT(native.size(), all.size());
    EXPECT_TRUE(std::equal(native.begin(), native.end(), all.begin())) << "the finest come first";
    EXPECT_NE(all[native.size()].key.zoom, kZoomNative);
    EXPECT_THAT(changed_tiles(snapshot, Layer::kOccupancy, revision), testing::IsEmpty());
    EXPECT_THAT(changed_tiles(snapshot, Layer::kOccupancy, revision + 1), testing::IsEmpty());
    EXPECT_THAT(changed_tiles(mapping::Snapshot{}, Layer::kOccupancy, 0), testing::IsEmpty());
}

/// What viewers keep: the bytes of tiles, by revision.
class Cache {
public:
    /// Compares with what was shown before, and takes in what is shown now.
    void look_at(const mapping::Snapshot& snapshot) {
        for (const Layer layer : mapping::kLayers) {
            for (const auto& [key, revision] : changed_tiles(snapshot, layer, 0)) {
                if (!is_looked_at(key)) continue;
                const auto codes = tile_codes(snapshot, layer, key);
                const auto at = std::tuple(layer, key.zoom, key.y, key.x);
                const auto [kept, is_new] = by_revision_.try_emplace({at, revision}, codes);
                ASSERT_TRUE(is_new || *kept->second == *codes)
                    << mapping::name_of(layer) << " " << key.zoom << "/" << key.x << "/" << key.y
                    << " is something else than it was at the same revision, " << revision;
                newest_[at] = codes;
            }
        }
    }

    /// Fails for a tile that does not look as it did and is not listed as changed since then.
    void expect_listed(const mapping::Snapshot& now, Revision since) const {
        for (const Layer layer : mapping::kLayers) {
            std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> listed;
            for (const auto& changed : changed_tiles(now, layer, since)) {
                listed.emplace(changed.key.zoom, changed.key.y, changed.key.x);
            }
            for (const auto& changed : changed_tiles(now, layer, 0)) {
                const auto& key = changed.key;
                if (!is_looked_at(key) || listed.contains({key.zoom, key.y, key.x})) continue;
                const auto kept = newest_.find(std::tuple(layer, key.zoom, key.y, key.x));
                ASSERT_TRUE(kept != newest_.end() && *kept->second == *tile_codes(now, layer, key))
                    << mapping::name_of(layer) << " " << key.zoom << "/" << key.x << "/" << key.y
                    << " changed unnoticed since " << since;
            }
        }
    }

private:
    [[nodiscard]] static bool is_looked_at(const TileKey& key) { return key.zoom == 9 || key.zoom == 6; }

    using Place = std::tuple<Layer, std::uint32_t, std::uint32_t, std::uint32_t>;
    std::map<std::pair<Place, Revision>, SharedBytes> by_revision_;
    std::map<Place, SharedBytes> newest_;
};

std::vector<LogEntry> walk_with_laser_and_sonar(std::size_t scans) {
    Sensor sonar{.id = 9, .kind = SensorKind::kSonar, .angles = UniformAngles{0.0, 1.0, 6}, .range_max = 4.0};
    std::vector<LogEntry> log{RobotJoined{0, "r"}, SensorDescribed{0, testing_support::small_laser()},
                              SensorDescribed{0, sonar}};
    for (std::uint64_t seq = 1; seq <= scans; ++seq) {
        Scan scan = testing_support::random_scan(77, seq);
        if (seq % 3 == 0) {
            scan.sensor = 9;
            scan.ranges.resize(6);
        }
        log.push_back(ScanTaken{0, std::move(scan)});
    }
    return log;
}

TEST(Changes, EqualRevisionsOfATileHaveEqualBytes) {
    const auto log = walk_with_laser_and_sonar(45);
    const auto config = mapping::resolve({.cell_size = 0.08, .danger_cells = 20}).value();
    Cache cache;
    for (const std::size_t looks_every : {1U, 4U}) {
        for (const std::size_t cut : {0U, 20U, 35U}) { // where the server is stopped and started again
            std::optional<mapping::Projection> projection(config);
            Cache viewer;
            Revision seen = 0;
            for (std::size_t n = 0; n < log.size(); ++n) {
                if (n == cut) projection.emplace(testing_support::restored(*projection));
                ASSERT_TRUE(projection->apply(log[n]));
                if (n % looks_every != 0) continue;
                const auto snapshot = projection->snapshot();
                ASSERT_NO_FATAL_FAILURE(cache.look_at(snapshot)) << "after entry " << n << ", cut at " << cut;
                ASSERT_NO_FATAL_FAILURE(viewer.expect_listed(snapshot, seen))
                    << "after entry " << n << ", cut at " << cut;
                viewer.look_at(snapshot);
                seen = snapshot.revision;
            }
        }
    }
}

using mapping::Layer;
using mapping::LogOdds;
using testing_support::HandMadeMap;
using testing_support::random_layers;

class TileOf : public testing::TestWithParam<Layer> {};

INSTANTIATE_TEST_SUITE_P(AnyLayer, TileOf, testing::ValuesIn(mapping::kLayers),
                         [](const auto& tried) { return std::string(mapping::name_of(tried.param)); });

TEST_P(TileOf, EqualsBruteForceAtEveryZoom) {
    const Layer layer = GetParam();
    const auto snapshot = random_layers(11);
    const auto pyramid = oracle::pyramid_of(snapshot, layer);
    ASSERT_GT(pyramid.size(), 200U);
    std::map<Code, int> seen;
    for (const auto& [at, pixels] : pyramid) {
        const auto [zoom, x, y] = at;
        Bytes expected(65536, oracle::unknown_code(layer));
        for (const auto& [pixel, oracle] : pixels) expected[static_cast<std::size_t>(pixel)] = oracle.code();
        for (const auto code : expected) ++seen[code];
        ASSERT_TRUE(*tile_codes(snapshot, layer, {zoom, x, y}) == expected) << zoom << "/" << x << "/" << y;
    }
    EXPECT_GE(seen.size(), layer == Layer::kHimm ? 17U : layer == Layer::kClassification ? 5U : 90U);
}

/// Free ground with one column of cells occupied, in every layer.
mapping::Snapshot ground_with_a_wall(std::int32_t wall) {
    mapping::LaserLayers lasers{mapping::MapConfig{}};
    mapping::SonarLayer sonars{mapping::MapConfig{}};
    classify::ClassLayer classes(3);
    std::map<grid::ChunkKey, classify::OccPlanes> types;
    std::vector<grid::ChunkKey> keys;
    for (std::int32_t cj = -11; cj < 11; ++cj) {
        for (std::int32_t ci = -2; ci < 2; ++ci) {
            auto& laser = lasers.restore({cj, ci}, 1);
            auto& sonar = sonars.restore({cj, ci}, 1);
            auto& planes = types[{cj, ci}];
            for (std::int32_t n = 0; n < 4096; ++n) {
                const bool is_wall = 64 * ci + n % 64 == wall;
                const auto at = static_cast<std::size_t>(n);
                laser.occupancy[at] = sonar.cells[at] = is_wall ? LogOdds{3000} : LogOdds{-14000};
                laser.himm[at] = is_wall ? 9 : 0;
                planes.set({n % 64, n / 64}, is_wall ? classify::OccType::kOccupied : classify::OccType::kFree);
            }
            keys.push_back({cj, ci});
        }
    }
    classes.update(
        keys, [&](grid::ChunkKey key) { return &types.at(key); }, 1);
    return {.revision = 1, .laser = lasers.snapshot(), .sonar = sonars.snapshot(), .classes = classes.snapshot()};
}

TEST_P(TileOf, ShowsAWallOfOneCellAtEveryZoom) {
    const Layer layer = GetParam();
    const auto snapshot = ground_with_a_wall(37);
    const Code wall = layer == Layer::kHimm ? 9 : layer == Layer::kClassification ? 2 : percent_table()[3000];
    for (std::uint32_t zoom = 0; zoom <= 9; ++zoom) {
        std::map<std::uint32_t, SharedBytes> column_of_tiles;
        for (std::int32_t j = -700; j < 700; ++j) {
            const auto key = tile_of({37, j}, zoom);
            auto& tile = column_of_tiles[key.y];
            if (!tile) tile = tile_codes(snapshot, layer, key);
            const auto cells = cells_of(key);
            const auto px = (37 - cells.i_begin) >> (9 - zoom);
            const auto py = (cells.j_end - 1 - j) >> (9 - zoom);
            ASSERT_EQ((*tile)[static_cast<std::size_t>(py * 256 + px)], wall) << "zoom " << zoom << ", row " << j;
        }
    }
}

TEST_P(TileOf, PngHasTheColoursOfItsCodes) {
    const Layer layer = GetParam();
    const auto snapshot = random_layers(13);
    const auto& style = style_of(layer);
    for (const TileKey key : {TileKey{9, 256, 255}, TileKey{7, 63, 64}, TileKey{0, 0, 0}, TileKey{9, 0, 5}}) {
        const auto tile = tile_codes(snapshot, layer, key);
        const auto png = tile_png(snapshot, layer, key);
        ASSERT_GT(png->size(), 26U);
        EXPECT_EQ(png->at(25), 3) << "the colour type of palettes";
        const cv::Mat image = cv::imdecode(*png, cv::IMREAD_COLOR);
        ASSERT_EQ(image.size(), cv::Size(256, 256));
        for (std::size_t n = 0; n < tile->size(); ++n) {
            const auto& bgr = image.at<cv::Vec3b>(static_cast<int>(n / 256), static_cast<int>(n % 256));
            const Colour expected = style.palette[(*tile)[n]];
            ASSERT_EQ((Colour{bgr[2], bgr[1], bgr[0]}), expected) << n;
        }
    }
}

TEST(Tile, UntouchedTilesShareOneUniformTile) {
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

TEST(Tile, PngHasTheFewestBitsPerPixel) {
    HandMadeMap map;
    const auto bits = [&] { return tile_png(map.snapshot(), Layer::kOccupancy, {9, 256, 255})->at(24); };
    EXPECT_EQ(bits(), 1);
    for (std::int32_t n = 0; n < 60; ++n) {
        map.set({n, 0}, static_cast<LogOdds>(150 * n)); // each another percentage, 50 and above
        const int colours = n + 2;                      // and unknown
        ASSERT_EQ(bits(), colours <= 2 ? 1 : colours <= 4 ? 2 : colours <= 16 ? 4 : 8) << colours;
    }
}

TEST(TileVersion, ChangesOnlyWithTheTile) {
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

TEST(TileVersion, EntityTagsAreStrongAndDistinct) {
    const TileKey key{9, 256, 255};
    const auto etag = etag_of("000000000000002a", "occupancy", key, 7);
    EXPECT_THAT(etag, testing::AllOf(testing::StartsWith("\""), testing::EndsWith("\"")));
    EXPECT_EQ(etag.find('"', 1), etag.size() - 1);
    EXPECT_EQ(etag, etag_of("000000000000002a", "occupancy", key, 7));
    EXPECT_NE(etag, etag_of("000000000000002b", "occupancy", key, 7)) << "a recreated session";
    EXPECT_NE(etag, etag_of("000000000000002a", "himm", key, 7));
    EXPECT_NE(etag, etag_of("000000000000002a", "occupancy", {9, 255, 256}, 7));
    EXPECT_NE(etag, etag_of("000000000000002a", "occupancy", key, 8));
}

} // namespace
} // namespace scanloom::tiles

#include "server/tiles/changes.hpp"

#include "server/tiles/tile.hpp"
#include "server/tiles/tile_version.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/random_scans.hpp"
#include "tests/support/restored.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <set>
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

TEST(Changes, ARevisionOfATileAlwaysMeansTheSameBytesAndNoChangeIsMissed) {
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
                ASSERT_TRUE(projection->fold(log[n]));
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

} // namespace
} // namespace scanloom::tiles

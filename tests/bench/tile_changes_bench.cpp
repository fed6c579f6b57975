#include "core/mapping/laser_layers.hpp"
#include "server/tiles/tile.hpp"

#include <benchmark/benchmark.h>

#include <utility>

// The cost of a change of one chunk to a viewer, against the map's extent: `chunks` of 64 x 64 cells along each side.
// It should be the same for all extents.

namespace scanloom::bench {
namespace {

using mapping::Layer;
using mapping::Snapshot;

/// A map, and the same map after a change in its middle.
struct Changed {
    Snapshot before;
    Snapshot after;
};

Changed changed_map(std::int32_t chunks) {
    mapping::LaserLayers layers{mapping::MapConfig{}};
    const auto fill = [&](grid::ChunkKey key, Revision revision) {
        auto& cells = layers.restore(key, revision).occupancy;
        for (std::size_t n = 0; n < cells.size(); ++n) {
            cells[n] = static_cast<mapping::LogOdds>(n % 97 == revision ? 3000 : -9000);
        }
    };
    for (std::int32_t cj = -chunks / 2; cj < chunks / 2; ++cj) {
        for (std::int32_t ci = -chunks / 2; ci < chunks / 2; ++ci) fill({cj, ci}, 1);
    }
    Snapshot before{.revision = 1, .laser = layers.snapshot()};
    fill({0, 0}, 2);
    return {std::move(before), {.revision = 2, .laser = layers.snapshot()}};
}

void ChangedTilesOfOneChunk(benchmark::State& state) {
    const auto maps = changed_map(static_cast<std::int32_t>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(tiles::changed_tiles(maps.after, Layer::kOccupancy, 1));
}

void TileRevision(benchmark::State& state) {
    const auto maps = changed_map(static_cast<std::int32_t>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(tiles::tile_revision(maps.after, Layer::kOccupancy, {1, 1, 0}));
}

void TileFromNothing(benchmark::State& state) {
    const auto maps = changed_map(static_cast<std::int32_t>(state.range(0)));
    const auto key = tiles::tile_of({0, 0}, static_cast<std::uint32_t>(state.range(1)));
    for (auto _ : state) benchmark::DoNotOptimize(tiles::tile_codes(maps.after, Layer::kOccupancy, key));
}

void TileFromTheOneBefore(benchmark::State& state) {
    const auto maps = changed_map(static_cast<std::int32_t>(state.range(0)));
    const auto key = tiles::tile_of({0, 0}, static_cast<std::uint32_t>(state.range(1)));
    const tiles::DrawnTile earlier{tiles::tile_codes(maps.before, Layer::kOccupancy, key), 1};
    for (auto _ : state) benchmark::DoNotOptimize(tiles::tile_codes(maps.after, Layer::kOccupancy, key, earlier));
}

void extents(benchmark::internal::Benchmark* bench) {
    bench->ArgName("chunks")->Arg(8)->Arg(32)->Arg(96)->Unit(benchmark::kMicrosecond);
}

void extents_and_zooms(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"chunks", "zoom"})->ArgsProduct({{8, 32, 96}, {5, 3, 0}})->Unit(benchmark::kMicrosecond);
}

BENCHMARK(ChangedTilesOfOneChunk)->Apply(extents);
BENCHMARK(TileRevision)->Apply(extents);
BENCHMARK(TileFromNothing)->Apply(extents_and_zooms);
BENCHMARK(TileFromTheOneBefore)->Apply(extents_and_zooms);

} // namespace
} // namespace scanloom::bench

#include "core/mapping/projection.hpp"
#include "core/mapping/snapshot.hpp"
#include "server/tiles/map_image.hpp"
#include "server/tiles/tile.hpp"
#include "tests/support/room_scans.hpp"

#include <benchmark/benchmark.h>

// The cost of integrating a scan and of showing a map, for the reference laser in a room of 10 x 10 m. Times are per
// scan; the argument is the cell size in millimetres. projection_bench compares with other mappers.

namespace scanloom::bench {
namespace {

using mapping::Snapshot;

double cell_size_of(const benchmark::State& state) { return static_cast<double>(state.range(0)) * 0.001; }

const std::vector<Scan>& scans() {
    static const auto scans = testing_support::room_scans(100);
    return scans;
}

/// The layers, ready to integrate scans of the reference laser.
class Mapper {
public:
    explicit Mapper(double cell_size_m)
        : fan_(mapping::make_laser_fan(config_of(cell_size_m), testing_support::reference_laser().angles, 0.0)),
          layers_(config_of(cell_size_m)) {}

    void integrate() {
        const Scan& scan = scans()[revision_ % scans().size()];
        double unbounded = HUGE_VAL;
        benchmark::DoNotOptimize(
            layers_.integrate({fan_, scan.ranges, *scan.pose, {0.0, 5.0, false}}, ++revision_, unbounded));
    }
    void take_snapshot() { benchmark::DoNotOptimize(layers_.snapshot()); }

private:
    static mapping::MapConfig config_of(double cell_size_m) {
        mapping::MapConfig config;
        config.cell_size = cell_size_m;
        return config;
    }

    mapping::LaserFan fan_;
    mapping::LaserLayers layers_;
    Revision revision_ = 0;
};

void Integrate(benchmark::State& state) {
    Mapper mapper(cell_size_of(state));
    for (auto _ : state) mapper.integrate();
}

void IntegrateAndSnapshot(benchmark::State& state) {
    Mapper mapper(cell_size_of(state));
    for (auto _ : state) {
        mapper.integrate();
        mapper.take_snapshot(); // so that the next scan copies each chunk it changes
    }
}

/// Returns adjacent rooms, 40 x 40 m in total, as 16 robots would map them at once.
Snapshot sixteen_rooms(double cell_size_m) {
    mapping::MapConfig config;
    config.cell_size = cell_size_m;
    mapping::Projection projection(config);
    for (std::uint32_t room = 0; room < 16; ++room) {
        benchmark::DoNotOptimize(projection.apply(RobotJoined{room, "robot"}));
        benchmark::DoNotOptimize(projection.apply(SensorDescribed{room, testing_support::reference_laser()}));
        for (Scan scan : scans()) {
            scan.pose->x += 10.0 * (room % 4) - 15.0;
            scan.pose->y += 10.0 * (room / 4) - 15.0;
            benchmark::DoNotOptimize(projection.apply(ScanTaken{room, std::move(scan)}));
        }
    }
    return projection.snapshot();
}

const Snapshot& shown_map() {
    static const Snapshot snapshot = sixteen_rooms(0.05);
    return snapshot;
}

tiles::TileKey tile_at_origin(const benchmark::State& state) {
    return tiles::tile_of({0, 0}, static_cast<std::uint32_t>(state.range(0)));
}

void Tile(benchmark::State& state) {
    const Snapshot& map = shown_map();
    for (auto _ : state)
        benchmark::DoNotOptimize(tiles::tile_codes(map, mapping::Layer::kOccupancy, tile_at_origin(state)));
}

void TilePng(benchmark::State& state) {
    const Snapshot& map = shown_map();
    for (auto _ : state)
        benchmark::DoNotOptimize(tiles::tile_png(map, mapping::Layer::kOccupancy, tile_at_origin(state)));
}

void ChangedTiles(benchmark::State& state) {
    const Snapshot& map = shown_map();
    const auto since = map.revision - static_cast<Revision>(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(tiles::changed_tiles(map, mapping::Layer::kOccupancy, since));
}

void MapPng(benchmark::State& state) {
    const Snapshot& map = shown_map();
    const auto frame = tiles::map_frame(map, mapping::Layer::kOccupancy, {}).value();
    for (auto _ : state)
        benchmark::DoNotOptimize(tiles::map_png(tiles::render_map(map, mapping::Layer::kOccupancy, frame)));
}

void Digest(benchmark::State& state) {
    const Snapshot& map = shown_map();
    for (auto _ : state) benchmark::DoNotOptimize(mapping::digest_of(map, mapping::Layer::kOccupancy));
}

BENCHMARK(Integrate)->Arg(10)->Arg(50)->Arg(100)->Arg(500)->Unit(benchmark::kMicrosecond);
BENCHMARK(IntegrateAndSnapshot)->Arg(10)->Arg(50)->Arg(100)->Arg(500)->Unit(benchmark::kMicrosecond);
BENCHMARK(Tile)->ArgName("zoom")->Arg(9)->Arg(7)->Arg(3)->Arg(0)->Unit(benchmark::kMicrosecond);
BENCHMARK(TilePng)->ArgName("zoom")->Arg(9)->Arg(7)->Arg(3)->Arg(0)->Unit(benchmark::kMicrosecond);
BENCHMARK(ChangedTiles)->ArgName("revisions")->Arg(1)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK(MapPng)->Unit(benchmark::kMillisecond);
BENCHMARK(Digest)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace scanloom::bench

#include "core/mapping/chunk_kernels.hpp"
#include "core/mapping/laser_layers.hpp"
#include "core/mapping/sweep/sweep.hpp"
#include "tests/bench/projection/columns.hpp"
#include "tests/bench/projection/peers.hpp"
#include "tests/support/instruction_set.hpp"

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>

// The cost of integrating one scan, for this projection and other mappers on the same scans in one run. Times are per
// scan, after all scans have been integrated once. "occupancy" is only our exact log-odds, which the others also
// compute; "all_layers" adds HIMM and the classes' hysteresis. When the same ground is observed repeatedly, its cells
// saturate and whole rows of saturated cells are skipped. "unsaturated" is "occupancy" that discards this information
// before each scan (the discarding is included in its time), so that every cell is read and written, as on new ground.
// The other mappers take the same time for both.
// All mappers except MRPT, which is Debian's package, are built for this machine's instruction set.

namespace scanloom::bench {
namespace {

mapping::MapConfig config_of(const Column& column) {
    mapping::MapConfig config;
    config.cell_size = column.cell_size;
    return config;
}

ReadingRules readings_of(const Column& column) { return {column.sensor.range_min, column.sensor.range_max, false}; }

std::shared_ptr<const mapping::LaserChunk> unknown_chunk() {
    auto chunk = std::make_shared<mapping::LaserChunk>();
    chunk->occupancy.fill(mapping::kUnknownLogOdds);
    return chunk;
}

/// Whether the projection knows which rows of cells are saturated, and skips them.
enum class Saturation { kKnown, kForgotten };

template <Saturation kSaturation>
class Occupancy final : public Mapper {
public:
    explicit Occupancy(const Column& column)
        : column_(column), rule_(config_of(column)), ring_(mapping::make_fan_ring(mapping::make_beam_fan(
                                                         column.sensor.angles, mapping::MapConfig{}.beam_aperture))) {}

    void insert(const Scan& scan) override {
        grid_.begin(++revision_);
        const mapping::Sweep::Band band{&ring_, mapping::MapConfig{}.obstacle_thickness};
        mapping::Sweep sweep({scan.ranges, *scan.pose, readings_of(column_), column_.cell_size}, {&band, 1});
        for (std::size_t strip = 0; strip < sweep.strips(); ++strip) {
            sweep.visit(strip, [&](grid::ChunkKey key, std::span<const mapping::ChunkVerdicts> verdicts) {
                mapping::LaserChunk& chunk = *grid_.write(key);
                if constexpr (kSaturation == Saturation::kForgotten) chunk.saturated_occupancy = {};
                mapping::simd::add_evidence(chunk, verdicts.front(), rule_);
            });
        }
    }

private:
    const Column& column_;
    mapping::OccupancyRule rule_;
    mapping::FanRing ring_;
    mapping::ChunkGrid<mapping::LaserChunk> grid_{unknown_chunk()};
    Revision revision_ = 0;
};

class AllLayers final : public Mapper {
public:
    explicit AllLayers(const Column& column)
        : column_(column), fan_(mapping::make_laser_fan(config_of(column), column.sensor.angles, 0.0)),
          layers_(config_of(column)) {}

    void insert(const Scan& scan) override {
        double unbounded = HUGE_VAL;
        benchmark::DoNotOptimize(
            layers_.integrate({fan_, scan.ranges, *scan.pose, readings_of(column_)}, ++revision_, unbounded));
    }

private:
    const Column& column_;
    mapping::LaserFan fan_;
    mapping::LaserLayers layers_;
    Revision revision_ = 0;
};

void run(benchmark::State& state, const Column& column, const Peer& peer) {
    const auto mapper = peer.make(column);
    for (const Scan& scan : column.scans) mapper->insert(scan);
    std::size_t next = 0;
    for (auto _ : state) {
        mapper->insert(column.scans[next]);
        next = next + 1 == column.scans.size() ? 0 : next + 1;
        benchmark::ClobberMemory();
    }
}

template <class Made>
Peer ours(std::string name) {
    return {std::move(name), [](const Column& column) { return std::make_unique<Made>(column); }};
}

void register_all() {
    std::vector<Peer> all{ours<Occupancy<Saturation::kKnown>>("occupancy"),
                          ours<Occupancy<Saturation::kForgotten>>("unsaturated"), ours<AllLayers>("all_layers")};
    all.insert(all.end(), peers().begin(), peers().end());
    for (const Column& column : columns()) {
        for (const Peer& peer : all) {
            benchmark::RegisterBenchmark(("Insert/" + column.name + "/" + peer.name).c_str(),
                                         [&column, peer](benchmark::State& state) { run(state, column, peer); })
                ->Unit(benchmark::kMicrosecond);
        }
    }
}

} // namespace
} // namespace scanloom::bench

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::AddCustomContext("instruction_set", std::string(scanloom::mapping::simd::instruction_set()));
    benchmark::AddCustomContext("mrpt", scanloom::bench::mrpt_version());
    scanloom::bench::register_all();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}

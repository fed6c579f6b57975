#include "sim/drive/wall_follower.hpp"
#include "sim/ground_truth.hpp"
#include "sim/map_world.hpp"
#include "sim/ray_casting.hpp"
#include "sim/robot/world_file.hpp"
#include "sim/simulator.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

// The simulator, one world after the other. "depot" is a map of ../shared/data and is left out if that is absent.

namespace scanloom::robot {
namespace {

/// Returns a map of 40 x 40 m in cells of 2 cm without straight lines: noise everywhere, except around a few places.
sim::World ragged_map() {
    constexpr std::size_t kSide = 2000;
    sim::Random random(1);
    MapCells cells{kSide, std::vector<MapCell>(kSide * kSide, MapCell::kFree)};
    for (std::size_t n = 0; n < cells.cells.size(); ++n) {
        const bool is_clear = n % kSide % 400 < 200 && n / kSide % 400 < 200;
        if (!is_clear && random.uniform(0.0, 1.0) < 0.009) cells.cells[n] = MapCell::kOccupied;
    }
    return sim::world_of_map("ragged", {.resolution = 0.02}, cells).value();
}

/// Returns the ground truth of the hall as a map.
sim::World hall_map() {
    const sim::GroundTruthGrid truth = ground_truth_of(sim::make_hall(), 0.05);
    const auto map = parse_ros_yaml(ground_truth_yaml(truth, "")).value();
    return sim::world_of_map("hall", map, read_ros_pgm(map, ground_truth_pgm(truth)).value()).value();
}

sim::World depot() {
    auto world = sim::load_world(SCANLOOM_SOURCE_DIR "/../shared/data/maps/depot/depot.yaml");
    return world ? std::move(*world) : sim::World{};
}

sim::World (*const kMakers[])() = {sim::make_office, sim::make_hall, hall_map, ragged_map, depot};

/// Returns the world for the benchmark's argument; without outlines if its file is absent.
const sim::World& world_of(benchmark::State& state) {
    static std::vector<sim::World> worlds(std::size(kMakers));
    sim::World& world = worlds[static_cast<std::size_t>(state.range(0))];
    if (world.outlines.empty()) world = kMakers[state.range(0)]();
    if (world.outlines.empty()) state.SkipWithError("recorded data, no part of the project, are not on this machine");
    return world;
}

/// Returns places to scan from.
std::vector<Pose2> places_in(const sim::World& world) {
    std::vector<Pose2> places;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        places.push_back(sim::Simulator({world, sim::find_laser("reference").value(), std::nullopt, seed},
                                        std::make_unique<sim::WallFollower>())
                             .pose());
    }
    return places;
}

void report(benchmark::State& state, const sim::World& world) {
    state.SetLabel(world.name + ", " + std::to_string(world.outlines.size()) + " outlines");
}

/// A scan of the reference laser, 684 beams.
void BM_scan(benchmark::State& state) {
    const sim::World& world = world_of(state);
    if (world.outlines.empty()) return;
    const Sensor laser = sim::find_laser("reference").value();
    const auto places = places_in(world);
    sim::Random random(1);
    std::size_t n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(sweep(world, laser, places[n++ % places.size()], std::nullopt, random));
    }
    report(state, world);
}
BENCHMARK(BM_scan)->DenseRange(0, 4)->Unit(benchmark::kMicrosecond);

/// A scan of the reference laser, computed by examining every outline for every beam.
void BM_scan_by_brute_force(benchmark::State& state) {
    const sim::World& world = world_of(state);
    if (world.outlines.empty()) return;
    const Sensor laser = sim::find_laser("reference").value();
    const auto places = places_in(world);
    std::size_t n = 0;
    for (auto _ : state) {
        const Pose2& place = places[n++ % places.size()];
        for (std::size_t i = 0; i < beam_count(laser.angles); ++i) {
            benchmark::DoNotOptimize(
                cast_ray(world.outlines, {place.x, place.y}, place.yaw + beam_angle(laser.angles, i)));
        }
    }
    report(state, world);
}
BENCHMARK(BM_scan_by_brute_force)->DenseRange(0, 4)->Unit(benchmark::kMicrosecond);

/// One reading of all 16 sonars.
void BM_sonars(benchmark::State& state) {
    const sim::World& world = world_of(state);
    if (world.outlines.empty()) return;
    const Sensor sonar = sim::find_sonar("ring16").value();
    const auto places = places_in(world);
    sim::Random random(1);
    std::size_t n = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(listen(world, sonar, places[n++ % places.size()], std::nullopt, random));
    }
    report(state, world);
}
BENCHMARK(BM_sonars)->DenseRange(0, 4)->Unit(benchmark::kMicrosecond);

/// The query of each control step.
void BM_clearance(benchmark::State& state) {
    const sim::World& world = world_of(state);
    if (world.outlines.empty()) return;
    const auto places = places_in(world);
    std::size_t n = 0;
    for (auto _ : state) {
        const Pose2& place = places[n++ % places.size()];
        benchmark::DoNotOptimize(clearance(world, {place.x, place.y}));
    }
    report(state, world);
}
BENCHMARK(BM_clearance)->DenseRange(0, 4);

/// A simulated tenth of a second with noise: two control steps and a scan.
void BM_simulator(benchmark::State& state) {
    const sim::World& world = world_of(state);
    if (world.outlines.empty()) return;
    sim::Simulator simulator({world, sim::find_laser("reference").value(), sim::Noise{}, 1},
                             std::make_unique<sim::WallFollower>());
    for (auto _ : state) benchmark::DoNotOptimize(simulator.next_scan());
    report(state, world);
    state.counters["times_real_time"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * sim::kScanPeriod, benchmark::Counter::kIsRate);
}
BENCHMARK(BM_simulator)->DenseRange(0, 4)->Unit(benchmark::kMicrosecond);

/// Converts cells to a world.
void BM_world_of_map(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(ragged_map());
}
BENCHMARK(BM_world_of_map)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace scanloom::robot

#include "core/landmarks/clustering.hpp"
#include "core/landmarks/landmark.hpp"
#include "core/landmarks/point_index.hpp"
#include "tests/bench/room_capture.hpp"

#include <benchmark/benchmark.h>

#include <map>

// Landmarks from the scans of a stationary lidar in the simulator's room, turn after turn.

namespace scanloom::landmarks {
namespace {

enum Cloud : std::int64_t {
    kMillimetres, ///< unmodified readings of 360 fixed directions: many are equal
    kJittered,    ///< every point moved by up to half a millimetre: no two are equal
};

std::vector<Point2> make_capture(Cloud cloud, std::size_t count) {
    auto points = bench::capture_in_map({-3.3, 1.2, 1.0}, count, 1);
    if (cloud != kJittered) return points;
    sim::Random random(2);
    for (Point2& point : points) point += Point2{random.uniform(-5e-4, 5e-4), random.uniform(-5e-4, 5e-4)};
    return points;
}

/// Returns the capture for the benchmark's arguments: type of cloud, number of points.
const std::vector<Point2>& capture(const benchmark::State& state) {
    static std::map<std::pair<std::int64_t, std::int64_t>, std::vector<Point2>> captures;
    auto& points = captures[{state.range(0), state.range(1)}];
    if (points.empty()) {
        points = make_capture(static_cast<Cloud>(state.range(0)), static_cast<std::size_t>(state.range(1)));
    }
    return points;
}

void finish(benchmark::State& state) {
    state.SetComplexityN(state.range(1));
    state.SetLabel(state.range(0) == kMillimetres ? "many equal" : "none equal");
}

template <std::int64_t cloud>
void sizes(benchmark::internal::Benchmark* bench) {
    for (const std::int64_t count : {1'000, 3'600, 12'000, 36'000, 120'000, 240'000, 1'200'000, 6'000'000}) {
        bench->Args({cloud, count});
    }
    bench->Unit(benchmark::kMillisecond)->Complexity(benchmark::oNLogN);
}

void FindLandmarks(benchmark::State& state) {
    const auto& points = capture(state);
    std::size_t count = 0;
    for (auto _ : state) {
        const auto landmarks = find_landmarks(points);
        if (!landmarks) return state.SkipWithError(landmarks.error().message.c_str());
        count = landmarks->size();
    }
    state.counters["landmarks"] = static_cast<double>(count);
    finish(state);
}
BENCHMARK(FindLandmarks)->Apply(sizes<kMillimetres>);
BENCHMARK(FindLandmarks)->Apply(sizes<kJittered>);

/// With an eps of 0.5 m each point has thousands of points within it.
void ClusterCrowds(benchmark::State& state) {
    const auto& points = capture(state);
    for (auto _ : state) benchmark::DoNotOptimize(dbscan(points, 0.5, 5));
    finish(state);
}
BENCHMARK(ClusterCrowds)->Apply(sizes<kJittered>);

/// The eps just above and below the value at which walls separate: many core points of adjacent cells are compared
/// without a match.
void ClusterByBeams(benchmark::State& state) {
    const auto& points = capture(state);
    for (auto _ : state) benchmark::DoNotOptimize(dbscan(points, 0.05, 5));
    finish(state);
}
BENCHMARK(ClusterByBeams)->Apply(sizes<kJittered>);

void MakePointTree(benchmark::State& state) {
    const auto& points = capture(state);
    for (auto _ : state) benchmark::DoNotOptimize(PointTree(points).size());
    finish(state);
}
BENCHMARK(MakePointTree)->Args({kJittered, 240'000})->Unit(benchmark::kMillisecond);

/// For every point of the cloud.
void FiveNearest(benchmark::State& state) {
    const auto& points = capture(state);
    const PointTree tree(points);
    std::size_t n = 0;
    for (auto _ : state) benchmark::DoNotOptimize(tree.nearest(points[n++ % points.size()], 5));
    finish(state);
}
BENCHMARK(FiveNearest)->Args({kJittered, 240'000});

} // namespace
} // namespace scanloom::landmarks

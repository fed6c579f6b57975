#include "core/landmarks/cloud_fusion.hpp"
#include "core/landmarks/landmark_matching.hpp"
#include "core/landmarks/localization.hpp"
#include "tests/bench/room_capture.hpp"

#include <benchmark/benchmark.h>

#include <memory>
#include <utility>

// Localization by, and fusing of, the scans of a stationary lidar from two places in the simulator's room.

namespace scanloom::landmarks {
namespace {

using bench::capture;
using bench::capture_in_map;

constexpr Pose2 kFirst{-3.3, 1.2, 1.0};
constexpr Pose2 kSecond{-2.6, 0.2, -2.0};

void LocateInOneView(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    ReferenceView first{.from = {kFirst.x, kFirst.y}};
    for (const Point2& point : capture_in_map(kFirst, count, 1)) first.points.push_back(in_millimetres(point));
    const ReferenceViews map = {std::make_shared<const ReferenceView>(std::move(first))};
    const auto second = capture(kSecond, count, 2);
    for (auto _ : state) {
        const auto found = locate(map, {.points = second});
        if (!found || found->certainty != Certainty::kClear) return state.SkipWithError("the pose is not clear");
        state.counters["inlier_ratio"] = found->inlier_ratio;
        state.counters["sigma_mm"] = 1e3 * found->position_sigma;
    }
}

void MatchTwoClouds(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const auto first = capture_in_map(kFirst, count, 1);
    const auto second = capture_in_map(kSecond, count, 2);
    for (auto _ : state) benchmark::DoNotOptimize(match(first, second, 0.05));
    state.SetComplexityN(state.range(0));
}

void FuseTwoClouds(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::vector<std::vector<Point2>> clouds = {capture_in_map(kFirst, count, 1),
                                                     capture_in_map(kSecond, count, 2)};
    for (auto _ : state) {
        const auto fused = fuse(clouds, 0.05);
        if (!fused) return state.SkipWithError(fused.error().message.c_str());
        state.counters["fused"] = static_cast<double>(fused->size());
    }
    state.SetComplexityN(state.range(0));
}

BENCHMARK(LocateInOneView)->Arg(360)->Arg(7'200)->Arg(120'000)->Unit(benchmark::kMillisecond);
BENCHMARK(MatchTwoClouds)->Arg(7'200)->Arg(120'000)->Unit(benchmark::kMillisecond);
BENCHMARK(FuseTwoClouds)
    ->Arg(7'200)
    ->Arg(30'000)
    ->Arg(120'000)
    ->Arg(480'000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity(benchmark::oNLogN);

} // namespace
} // namespace scanloom::landmarks

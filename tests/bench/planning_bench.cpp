#include "core/planning/coverage.hpp"
#include "core/planning/goals.hpp"
#include "tests/support/plan_worlds.hpp"

#include <benchmark/benchmark.h>

// Planning on 60 x 40 m at 0.05 m with a body radius of 0.15 m: from the classes to the finished polyline.

namespace scanloom::bench {
namespace {

using classify::ClassView;
using testing_support::centre;

constexpr double kCellSize = 0.05;
constexpr std::int32_t kWidth = 1200;
constexpr std::int32_t kHeight = 800;

const ClassView& office() {
    static const ClassView view = testing_support::office(kWidth, kHeight, 5).view();
    return view;
}

const ClassView& maze() {
    static const ClassView view = testing_support::maze(kWidth, kHeight, 25, 6).view();
    return view;
}

const ClassView& open_hall() {
    static const ClassView view = [] {
        testing_support::PlanWorld world(kWidth, kHeight, classify::OccType::kFree);
        world.frame(1);
        return world.view();
    }();
    return view;
}

/// Returns the maze with its last square walled in.
const ClassView& closed_maze() {
    static const ClassView view = [] {
        auto world = testing_support::maze(kWidth, kHeight, 25, 6);
        world.fill(1175, 775, 1, 25, classify::OccType::kOccupied);
        world.fill(1175, 775, 25, 1, classify::OccType::kOccupied);
        return world.view();
    }();
    return view;
}

/// Plans from the lower left corner to the upper right corner.
void plan_across(benchmark::State& state, const ClassView& view, bool possible) {
    const Point2 start = centre({12, 12}, kCellSize);
    const Point2 goal = centre({1187, 787}, kCellSize);
    double length = 0.0;
    for (auto _ : state) {
        const auto path = planning::plan_path(view, kCellSize, start, goal, {.on_known = true});
        if (path.has_value() != possible) return state.SkipWithError("the path has not the expected result");
        if (path) length = path->length_m;
    }
    state.counters["length_m"] = length;
}

void PathAcrossOffice(benchmark::State& state) {
    const auto view = office();
    const Point2 start = centre({20, 100}, kCellSize);
    const Point2 goal = centre({1180, 700}, kCellSize);
    for (auto _ : state) {
        const auto path = planning::plan_path(view, kCellSize, start, goal, {.on_known = true});
        if (!path) return state.SkipWithError(path.error().message.c_str());
        state.counters["length_m"] = path->length_m;
    }
}
void PathAcrossMaze(benchmark::State& state) { plan_across(state, maze(), true); }
void PathAcrossOpenHall(benchmark::State& state) { plan_across(state, open_hall(), true); }
void PathToUnreachableGoal(benchmark::State& state) { plan_across(state, closed_maze(), false); }

void PassabilityOfOffice(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(planning::make_passability(office(), kCellSize, {}));
}

void CostsFromOnePlaceInOffice(benchmark::State& state) {
    const auto passability = planning::make_passability(office(), kCellSize, {}).value();
    for (auto _ : state) {
        planning::CostSearch search(passability);
        search.from({20, 100});
        benchmark::DoNotOptimize(search);
    }
}

/// The changes of one scan: a fan of 5 m, 16 chunks, whose cells all change between free and unexplored.
void ClassesOfAScan(benchmark::State& state) {
    classify::ClassLayer layer(3);
    std::array<classify::OccPlanes, 2> planes;
    planes[0].free.fill(~std::uint64_t{0});
    planes[0].set({16, 31}, classify::OccType::kOccupied);
    std::vector<grid::ChunkKey> changed;
    for (std::int32_t chunk = 0; chunk < 16; ++chunk) changed.push_back({chunk / 4, chunk % 4});
    Revision revision = 0;
    for (auto _ : state) {
        layer.update(
            changed, [&](grid::ChunkKey) { return &planes[revision % static_cast<Revision>(state.range(0))]; },
            revision + 1);
        ++revision;
        benchmark::DoNotOptimize(layer.snapshot());
    }
}

void NextGoalInOffice(benchmark::State& state) {
    static const ClassView view = [] {
        const auto world = testing_support::office(kWidth, kHeight, 5);
        return testing_support::classified({0, 0, kWidth, kHeight}, 3, [&](grid::Cell cell) {
            return cell.i > 800 || (cell.i / 90 + cell.j / 70) % 5 == 0 ? classify::OccType::kUnexplored
                                                                        : world.at(cell);
        });
    }();
    for (auto _ : state) {
        const auto goal = planning::next_goal(view, kCellSize, centre({100, 100}, kCellSize));
        if (!goal) return state.SkipWithError(goal.error().message.c_str());
        state.counters["length_m"] = goal->path.length_m;
    }
    state.counters["frontiers"] = static_cast<double>(classify::find_frontiers(view).size());
}

void CoverageOfOffice(benchmark::State& state) {
    for (auto _ : state) {
        const auto coverage = planning::plan_coverage(office(), kCellSize, centre({20, 100}, kCellSize));
        if (!coverage) return state.SkipWithError(coverage.error().message.c_str());
        state.counters["length_m"] = coverage->path.length_m;
        state.counters["free_m2"] = static_cast<double>(coverage->free_cells) * kCellSize * kCellSize;
        state.counters["fraction"] = coverage->fraction;
    }
}

BENCHMARK(ClassesOfAScan)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);
BENCHMARK(NextGoalInOffice)->Unit(benchmark::kMillisecond);
BENCHMARK(CoverageOfOffice)->Unit(benchmark::kMillisecond);
BENCHMARK(PathAcrossOffice)->Unit(benchmark::kMillisecond);
BENCHMARK(PathAcrossMaze)->Unit(benchmark::kMillisecond);
BENCHMARK(PathAcrossOpenHall)->Unit(benchmark::kMillisecond);
BENCHMARK(PathToUnreachableGoal)->Unit(benchmark::kMillisecond);
BENCHMARK(PassabilityOfOffice)->Unit(benchmark::kMillisecond);
BENCHMARK(CostsFromOnePlaceInOffice)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace scanloom::bench

#include "core/planning/search_window.hpp"

#include "core/planning/grid_path.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace scanloom::planning {
namespace {

using namespace testing_support;
using grid::CellBox;
using testing::HasSubstr;

/// Marks a square of cells as free; `corner` is its lower left cell.
void explore(ClassMap& map, Cell corner, std::int32_t side) {
    for (std::int32_t j = 0; j < side; ++j) {
        for (std::int32_t i = 0; i < side; ++i) map.set({corner.i + i, corner.j + j}, CellClass::kFree);
    }
}

TEST(SearchWindow, WithoutEndsCoversAllExploredChunks) {
    ClassMap map;
    map.set({-1, 5}, CellClass::kFree);
    map.set({200, -70}, CellClass::kFree);
    EXPECT_EQ(search_window(map.view(), 0.05, {})->box, (CellBox{-64, -128, 256, 64}));
    EXPECT_EQ(search_window(map.view(), 0.05, {.allow_unknown = true})->box, (CellBox{-128, -192, 320, 128}));
}

TEST(SearchWindow, InExploredSpaceCoversTheAreaAroundTheFirstEnd) {
    ClassMap map;
    for (const std::int32_t far : {-10'000'000, 640, 10'000'000}) map.set({far, far}, CellClass::kOccupied);
    explore(map, {60, 60}, 8); // touches four chunks, two of them at a corner
    const std::vector<Point2> ends = {{3.1, 3.1}, {32.0, 32.0}};
    EXPECT_EQ(search_window(map.view(), 0.05, {}, ends)->box, (CellBox{0, 0, 128, 128}));
}

TEST(SearchWindow, IsEmptyAroundAPointFarFromExploredCells) {
    const std::vector<Point2> ends = {{100.0, 100.0}};
    EXPECT_TRUE(search_window(drawn({"."}), 0.05, {}, ends)->box.empty());
    EXPECT_TRUE(search_window(ClassView{}, 0.05, {}, ends)->box.empty());
}

TEST(SearchWindow, MergesAreasIfTheBodySpansTheGap) {
    ClassMap map;
    map.set({63, 0}, CellClass::kFree);
    map.set({128, 0}, CellClass::kOccupied); // 64 unexplored cells between them
    const std::vector<Point2> ends = {{63.5, 0.5}};
    EXPECT_EQ(search_window(map.view(), 1.0, {.body_radius_m = 60.0}, ends)->box, (CellBox{0, 0, 64, 64}));
    EXPECT_EQ(search_window(map.view(), 1.0, {.body_radius_m = 65.0}, ends)->box, (CellBox{0, 0, 192, 64}));
}

TEST(SearchWindow, WithUnknownAllowedContainsBothEndsAndTouchedAreas) {
    ClassMap map;
    map.set({0, 0}, CellClass::kFree);
    map.set({150, 0}, CellClass::kOccupied);  // next to the box around the first end: extends the box
    map.set({310, 0}, CellClass::kOccupied);  // next to the extended box
    map.set({1500, 0}, CellClass::kOccupied); // far away
    const std::vector<Point2> ends = {{0.5, 0.5}, {0.5, -300.0}};
    EXPECT_EQ(search_window(map.view(), 1.0, {.allow_unknown = true}, ends)->box, (CellBox{-64, -384, 384, 128}));
}

TEST(SearchWindow, RefusesTooLargeWindowButIgnoresDistantScans) {
    ClassMap map;
    map.set({0, 0}, CellClass::kFree);
    map.set({100'000, 100'000}, CellClass::kFree);
    const auto window = search_window(map.view(), 0.05, {});
    ASSERT_FALSE(window);
    EXPECT_EQ(window.error().code, Errc::kTooLarge);
    EXPECT_THAT(window.error().message, HasSubstr("100032 x 100032 cells"));
    const std::vector<Point2> ends = {{0.01, 0.01}};
    for (const bool allow_unknown : {false, true}) {
        EXPECT_TRUE(search_window(map.view(), 0.05, {.allow_unknown = allow_unknown}, ends));
    }
}

TEST(SearchWindow, IgnoresChunksAtIntegerLimits) {
    ClassMap map;
    map.set({0, 0}, CellClass::kFree);
    map.set({std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()}, CellClass::kFree);
    map.set({std::numeric_limits<std::int32_t>::max() - 127, 0}, CellClass::kFree);
    EXPECT_EQ(search_window(map.view(), 1.0, {})->box, (CellBox{0, 0, 64, 64}));
    const Reach unknown{.allow_unknown = true};
    const std::vector<Point2> far = {{0.0, 0.0}, {2147400000.0, 0.0}};
    EXPECT_EQ(search_window(map.view(), 1.0, unknown, far).error().code, Errc::kTooLarge);
    for (const double bad : {2147483000.0, -1e300, std::nan(""), kInfinite}) {
        const std::vector<Point2> ends = {{0.0, bad}};
        EXPECT_EQ(search_window(map.view(), 1.0, unknown, ends).error().code, Errc::kInvalidField);
    }
}

TEST(SearchWindow, AcceptsLongThinAreaInMostlyUnexploredBox) {
    constexpr std::int32_t kLength = 10'000;
    ClassMap map;
    for (std::int32_t n = 0; n < kLength; ++n) {
        for (std::int32_t i = 0; i < 10; ++i) map.set({n + i, n}, CellClass::kFree);
    }
    const auto path = plan_path(map.view(), 0.05, {0.225, 0.025}, {500.125, 499.925}, {}, Shape::kSteps);
    ASSERT_TRUE(path) << path.error().message;
    EXPECT_NEAR(path->length_m, 0.05 * std::sqrt(2.0) * (kLength - 1), 0.2);
}

/// Returns islands of free and occupied cells, many of them separated by unexplored chunks.
ClassView islands(std::mt19937& random) {
    std::uniform_int_distribution<std::int32_t> corner(-300, 300);
    std::uniform_int_distribution<std::int32_t> side(5, 90);
    ClassMap map;
    for (int n = 0; n < 9; ++n) {
        const Cell at{corner(random), corner(random)};
        explore(map, at, side(random));
        for (std::int32_t wall = side(random); wall > 0; --wall) {
            map.set({at.i + wall, at.j + (n % 3) * wall}, CellClass::kOccupied);
        }
    }
    return map.view();
}

TEST(SearchWindow, PathInWindowCostsAsMuchAsInTheWholeMap) {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> metres(-300.0, 300.0);
    int paths = 0;
    for (int round = 0; round < 400; ++round) {
        const auto view = islands(random);
        const PassabilityOptions options{
            .body_radius_m = (round % 5) * 20.0 / 16.0, .allow_unknown = round % 2 == 1, .on_known = round % 4 == 0};
        Point2 start{metres(random), metres(random)};
        const Point2 goal = round % 3 == 0 ? start + Point2{3.0, 2.0} : Point2{metres(random), metres(random)};
        auto whole = make_passability(view, 1.0, options).value();
        const auto first = open_start(whole, start);
        const auto last = check_goal(whole, goal);
        const bool leads = first && last && connected(whole.enterable, *first).test(*last);
        const auto path = plan_path(view, 1.0, start, goal, options, Shape::kSteps);
        if (!leads && options.allow_unknown && path) continue; // the path runs outside the whole map
        ASSERT_EQ(path.has_value(), leads) << "round " << round;
        if (!path) continue;
        ++paths;
        CostSearch search(whole);
        search.between(*first, *last);
        const auto expected = to_path(whole, search.path_to(*last), start, goal, Shape::kSteps);
        EXPECT_NEAR(path->cost, expected.cost, 1e-9) << "round " << round;
    }
    EXPECT_GT(paths, 60);
}

} // namespace
} // namespace scanloom::planning

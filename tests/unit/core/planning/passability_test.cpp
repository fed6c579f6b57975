#include "core/planning/passability.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::planning {
namespace {

using namespace testing_support;
using testing::HasSubstr;

Errc code_of(const Result<Spot>& result) { return result ? Errc::kInternal : result.error().code; }
std::string message_of(const Result<Spot>& result) { return result ? "no error" : result.error().message; }

TEST(Passability, EnterableCellsKeepBodyRadiusFromEveryOccupiedSquare) {
    std::mt19937 random(21);
    const grid::CellBox box{-40, -30, 50, 40};
    for (const double radius : {0.0, 0.02, 0.05, 0.1, 0.15, 0.26, 0.5}) {
        for (const auto& [allow_unknown, on_known] : {std::pair{false, false}, {true, false}, {false, true}}) {
            const auto view = scattered(random, box, radius > 0.2 ? 1 : 4);
            const PassabilityOptions options{radius, 1.0, allow_unknown, on_known};
            const auto passability = make_passability(view, 0.05, options).value();
            const Oracle oracle(view, box, 0.05, options);
            for (std::int32_t j = box.j_begin; j < box.j_end; ++j) {
                for (std::int32_t i = box.i_begin; i < box.i_end; ++i) {
                    const Spot spot = passability.spot_of({i, j}).value();
                    ASSERT_EQ(passability.enterable.test(spot), oracle.enterable({i, j}))
                        << "cell " << i << ", " << j << ", radius " << radius;
                    const auto value = class_at(view, {i, j});
                    ASSERT_EQ(passability.ground.test(spot), value == CellClass::kFree || value == CellClass::kDanger ||
                                                                 (allow_unknown && value != CellClass::kOccupied));
                    ASSERT_EQ(passability.danger.test(spot), class_at(view, {i, j}) == CellClass::kDanger);
                    ASSERT_EQ(passability.occupied.test(spot), class_at(view, {i, j}) == CellClass::kOccupied);
                }
            }
        }
    }
}

TEST(Passability, RadiusIncludesCellsAtExactlyThatDistance) {
    const auto view = drawn({"#........."});
    const auto passability = make_passability(view, 0.05, {.body_radius_m = 0.175}).value();
    EXPECT_FALSE(passability.enterable.test({4, 0}))
        << "its centre is 3.5 cells from the square, which equals the radius";
    EXPECT_TRUE(passability.enterable.test({5, 0}));
}

TEST(Passability, WindowCoversTheMapsChunks) {
    ClassMap map;
    map.set({-1, 5}, CellClass::kFree);
    map.set({200, -70}, CellClass::kFree);
    const auto passability = make_passability(map.view(), 0.05, {}).value();
    EXPECT_EQ(passability.window, (grid::CellBox{-64, -128, 256, 64}));
    EXPECT_EQ(passability.cell_at({1, 2}), (Cell{-63, -126}));
    EXPECT_EQ(passability.spot_at({-0.01, 0.26}), (Spot{63, 133}));
    EXPECT_EQ(passability.spot_at({-3.3, 0.0}), std::nullopt);
    EXPECT_EQ(passability.centre_of({64, 128}), (Point2{0.025, 0.025}));
}

TEST(Passability, RefusesOptionsOutOfRangeByName) {
    const auto refusal = [](const PassabilityOptions& options) {
        return make_passability(drawn({"."}), 0.05, options).error();
    };
    for (const double bad : {-0.1, 6.0, std::nan(""), kInfinite}) {
        EXPECT_EQ(refusal({.body_radius_m = bad}).code, Errc::kInvalidField);
        EXPECT_THAT(refusal({.body_radius_m = bad}).message, HasSubstr("body_radius"));
    }
    for (const double bad : {-1.0, 1001.0, std::nan("")}) {
        EXPECT_THAT(refusal({.danger_cost = bad}).message, HasSubstr("danger_cost"));
    }
}

TEST(Passability, RefusesInvalidStartWithTheReason) {
    const auto view = drawn({"#.?f!"});
    auto passability = make_passability(view, 1.0, {.body_radius_m = 0.0}).value();
    EXPECT_EQ(code_of(open_start(passability, {0.5, 0.5})), Errc::kNoPath);
    EXPECT_THAT(message_of(open_start(passability, {0.5, 0.5})), HasSubstr("start (0.5, 0.5) is inside an obstacle"));
    EXPECT_THAT(message_of(open_start(passability, {2.5, 0.5})), HasSubstr("unknown space"));
    EXPECT_THAT(message_of(open_start(passability, {3.5, 0.5})), HasSubstr("unknown space"));
    EXPECT_THAT(message_of(open_start(passability, {-0.5, 0.5})), HasSubstr("outside the map"));
    EXPECT_EQ(code_of(open_start(passability, {std::nan(""), 0.5})), Errc::kInvalidField);
    EXPECT_EQ(code_of(open_start(passability, {1e300, 0.5})), Errc::kInvalidField);
    EXPECT_EQ(open_start(passability, {1.5, 0.5}).value(), (Spot{1, 0}));
    EXPECT_EQ(open_start(passability, {4.5, 0.5}).value(), (Spot{4, 0}));
}

TEST(Passability, RefusesInvalidGoalWithTheReason) {
    const auto view = drawn({"#..?."});
    const auto passability = make_passability(view, 1.0, {.body_radius_m = 1.0}).value();
    EXPECT_THAT(message_of(check_goal(passability, {0.5, 0.5})), HasSubstr("goal (0.5, 0.5) is inside an obstacle"));
    EXPECT_THAT(message_of(check_goal(passability, {1.5, 0.5})), HasSubstr("nearer to an obstacle than the body"));
    EXPECT_THAT(message_of(check_goal(passability, {3.5, 0.5})), HasSubstr("unknown space"));
    EXPECT_THAT(message_of(check_goal(passability, {70.0, 0.5})), HasSubstr("outside the explored area"));
    EXPECT_EQ(code_of(check_goal(passability, {0.5, kInfinite})), Errc::kInvalidField);
    EXPECT_EQ(check_goal(passability, {2.5, 0.5}).value(), (Spot{2, 0}));
}

TEST(Passability, StartNextToAnObstacleOpensOnlyNearbyCells) {
    const auto view = drawn({"..........", "..........", "..........", "..........", "##########"});
    auto passability = make_passability(view, 1.0, {.body_radius_m = 1.6}).value();
    ASSERT_FALSE(passability.enterable.test({2, 1}));
    ASSERT_TRUE(passability.enterable.test({2, 3}));
    ASSERT_TRUE(open_start(passability, {2.5, 1.5}));
    EXPECT_TRUE(passability.enterable.test({2, 1}));
    EXPECT_TRUE(passability.enterable.test({2, 2}));
    EXPECT_TRUE(passability.enterable.test({4, 1})) << "the cell is 2 cells away, which is within 1.6 + 1";
    EXPECT_FALSE(passability.enterable.test({5, 1}));
    EXPECT_FALSE(passability.enterable.test({2, 0})) << "the cell of the obstacle stays closed";
}

TEST(Passability, EmptyMapRefusesEveryStart) {
    auto passability = make_passability(ClassView{}, 0.05, {}).value();
    EXPECT_THAT(message_of(open_start(passability, {0.0, 0.0})), HasSubstr("outside the map"));
}

} // namespace
} // namespace scanloom::planning

#include "core/planning/line_of_sight.hpp"
#include "tests/support/point_text.hpp"
#include "tests/unit/core/planning/path_oracle.hpp"

#include <gtest/gtest.h>

namespace scanloom::planning {
namespace {

using namespace testing_support;

TEST(Clearance, MatchesDistanceFromLineToEveryOccupiedSquare) {
    std::mt19937 random(41);
    const grid::CellBox box{0, 0, 60, 50};
    int clear = 0;
    int touching = 0;
    for (int map = 0; map < 40; ++map) {
        const auto view = scattered(random, box, 1);
        const PassabilityOptions options{.body_radius_m = std::array{0.3, 0.5, 1.0, 1.5, 2.7, 4.2}[random() % 6],
                                         .on_known = map % 4 == 0};
        const auto passability = make_passability(view, 1.0, options).value();
        const Oracle oracle(view, box, 1.0, options);
        std::uniform_real_distribution<double> coordinate(0.0, 50.0);
        std::uniform_real_distribution<double> step(-6.0, 6.0);
        for (int line = 0; line < 200; ++line) {
            Point2 from{coordinate(random), coordinate(random)};
            Point2 to = from + Point2{step(random), step(random)};
            if (line % 4 == 0) to = from;
            if (line % 4 == 1) to.x = from.x;
            if (line % 4 == 2) to.y = from.y;
            if (line % 8 >= 4) { // these lines touch squares at their corners
                from = {std::round(from.x * 2.0) / 2.0, std::round(from.y * 2.0) / 2.0};
                to = {std::round(to.x * 2.0) / 2.0, std::round(to.y * 2.0) / 2.0};
            }
            const bool expected = oracle.keeps_clear(from, to);
            ASSERT_EQ(keeps_clear(passability, from, to), expected)
                << text_of(from) << " to " << text_of(to) << ", radius " << options.body_radius_m;
            (expected ? clear : touching) += 1;
        }
    }
    EXPECT_GT(clear, 1000);
    EXPECT_GT(touching, 1000);
}

TEST(Clearance, ZeroRadiusAlwaysKeepsClear) {
    const auto passability = make_passability(drawn({"#.", ".."}), 1.0, {.body_radius_m = 0.0}).value();
    EXPECT_TRUE(keeps_clear(passability, {1.0, 1.5}, {1.0, 1.0}));
}

} // namespace
} // namespace scanloom::planning

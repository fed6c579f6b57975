#include "core/scan_matching/square_set.hpp"
#include "tests/support/building.hpp"
#include "tests/support/uniform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <set>
#include <utility>

namespace scanloom::scan_matching {
namespace {

using testing_support::uniform;

TEST(SquareSet, KnowsTheSquaresThatASetOfThemKnows) {
    std::mt19937 random(1);
    for (const double side : {0.05, 0.25, 1.0}) {
        for (const double reach : {0.5, 3.0, 1e4}) { // metres: many points in few squares, and few in many
            constexpr std::size_t kPoints = 3000;
            SquareSet squares(side, kPoints);
            std::set<std::pair<double, double>> expected;
            for (std::size_t n = 0; n < kPoints; ++n) {
                const double x = uniform(random, -reach, reach);
                const double y = uniform(random, -reach, reach);
                const bool is_new = expected.emplace(std::floor(x / side), std::floor(y / side)).second;
                ASSERT_EQ(squares.insert(x, y), is_new) << x << ", " << y;
            }
        }
    }
}

TEST(SquareSet, SquaresBeginAtTheirLowerLeftCorner) {
    SquareSet squares(0.5, 8);
    EXPECT_TRUE(squares.insert(0.0, 0.0));
    EXPECT_FALSE(squares.insert(-0.0, 0.49));
    EXPECT_TRUE(squares.insert(0.5, 0.0)) << "the one on the right";
    EXPECT_TRUE(squares.insert(0.0, 0.5)) << "the one above";
    EXPECT_TRUE(squares.insert(-0.01, 0.0)) << "the one on the left, not the same rounded to 0";
    EXPECT_TRUE(squares.insert(0.0, -0.01));
    EXPECT_TRUE(squares.insert(-0.01, -0.01));
    EXPECT_FALSE(squares.insert(-0.5, -0.5));
}

/// All squares of a rectangle, as many as expected, and no others: also neighbours whose places in memory are close.
TEST(SquareSet, HoldsAsManySquaresAsExpected) {
    for (const auto& [columns, rows] : {std::pair{1, 1}, {2, 3}, {100, 100}, {2000, 5}, {5, 2000}}) {
        SquareSet squares(1.0, static_cast<std::size_t>(columns * rows));
        for (const bool is_new : {true, false}) {
            for (int row = 0; row < rows; ++row) {
                for (int column = 0; column < columns; ++column) {
                    ASSERT_EQ(squares.insert(column - columns / 2, row - rows / 2), is_new) << column << ", " << row;
                }
            }
        }
    }
}

TEST(SquareSet, FarSquaresAreDifferent) {
    SquareSet squares(1.0, 6);
    constexpr double kFar = 2147483647.0; // 2^31 - 1
    for (const bool is_new : {true, false}) {
        EXPECT_EQ(squares.insert(kFar, 0.0), is_new);
        EXPECT_EQ(squares.insert(0.0, kFar), is_new);
        EXPECT_EQ(squares.insert(-kFar, 0.0), is_new);
        EXPECT_EQ(squares.insert(0.0, -kFar), is_new);
        EXPECT_EQ(squares.insert(-kFar, -kFar), is_new);
        EXPECT_EQ(squares.insert(0.0, 0.0), is_new);
    }
}

} // namespace
} // namespace scanloom::scan_matching

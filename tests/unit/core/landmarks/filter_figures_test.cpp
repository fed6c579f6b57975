#include "core/landmarks/filter_figures.hpp"
#include "tests/support/angles.hpp"
#include "tests/unit/core/landmarks/random_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scanloom::landmarks {
namespace {

using namespace testing_support;

/// Returns the median of each reading and its neighbours, with smaller windows at the ends.
std::vector<RangeMm> medians_of(const std::vector<RangeMm>& ranges, std::size_t window) {
    std::vector<RangeMm> medians;
    for (std::size_t n = 0; n < ranges.size(); ++n) {
        const std::size_t reach = std::min({window / 2, n, ranges.size() - 1 - n});
        const auto begin = ranges.begin() + static_cast<std::ptrdiff_t>(n - reach);
        std::vector<RangeMm> around(begin, begin + static_cast<std::ptrdiff_t>(2 * reach + 1));
        std::ranges::sort(around);
        medians.push_back(around[reach]);
    }
    return medians;
}

/// A wall 2 m ahead, observed over 90 degrees with noise of up to +-20 mm.
struct NoisyWall {
    BeamAngles angles = UniformAngles{-kPi / 4, kPi / 2 / 200, 201};
    std::vector<RangeMm> ranges;

    NoisyWall() {
        std::mt19937 random(1);
        for (std::size_t n = 0; n < 201; ++n) {
            ranges.push_back(to_range_mm(2.0 / std::cos(beam_angle(angles, n)) + uniform(random, -0.02, 0.02)));
        }
    }
};

TEST(FilterFigures, AreZeroForUnchangedScans) {
    const NoisyWall wall;
    const auto figures = filter_figures(wall.ranges, wall.ranges, wall.angles);
    EXPECT_EQ(figures.rmse, 0.0);
    EXPECT_EQ(figures.noise_reduction_x, 0.0);
    EXPECT_EQ(figures.noise_reduction_y, 0.0);
}

TEST(FilterFigures, MedianFilterRemovesMostNoise) {
    const NoisyWall wall;
    for (const std::size_t window : {3U, 5U, 9U}) {
        const auto after = medians_of(wall.ranges, window);
        const auto figures = filter_figures(wall.ranges, after, wall.angles);
        EXPECT_GT(figures.rmse, 0.005) << window;
        EXPECT_LT(figures.rmse, 0.02) << window;
        EXPECT_GT(figures.noise_reduction_x.value(), 0.5) << window;
        EXPECT_GT(figures.noise_reduction_y.value(), 0.5) << window;
    }
}

TEST(FilterFigures, AddedNoiseIsNegativeReduction) {
    const NoisyWall wall;
    std::vector<RangeMm> rougher = wall.ranges;
    for (std::size_t n = 0; n < rougher.size(); n += 2) rougher[n] += 100;
    EXPECT_LT(filter_figures(wall.ranges, rougher, wall.angles).noise_reduction_x.value(), -1.0);
}

TEST(FilterFigures, RmseUsesReturnsOnly) {
    const BeamAngles angles = UniformAngles{0.0, 0.1, 4};
    const std::vector<RangeMm> before = {1000, kInvalidRange, kNoReturn, 2000};
    const std::vector<RangeMm> after = {1003, kInvalidRange, kNoReturn, 1996};
    EXPECT_NEAR(filter_figures(before, after, angles).rmse, std::sqrt((9.0 + 16.0) / 2.0) * 1e-3, 1e-12);
}

TEST(FilterFigures, RoughnessUsesThreeNeighbouringReturns) {
    // All beams have angle 0. The second differences along x are 4, 6 and, after the gap, 1.
    const BeamAngles angles = ExplicitAngles(8, 0.0);
    const std::vector<RangeMm> before = {1000, 1002, 1000, 1004, kInvalidRange, 3000, 3001, 3003};
    const std::vector<RangeMm> after = {1000, 1001, 1000, 1001, kInvalidRange, 3000, 3001, 3003};
    const auto figures = filter_figures(before, after, angles);
    EXPECT_NEAR(figures.noise_reduction_x.value(), 1.0 - 2.0 / 4.0, 1e-9);
    EXPECT_EQ(figures.noise_reduction_y, std::nullopt);
}

TEST(FilterFigures, FullCircleWrapsAround) {
    const BeamAngles angles = UniformAngles{0.0, kPi / 2, 4};
    const std::vector<RangeMm> before = {1000, 1000, 2000, 1000};
    const std::vector<RangeMm> after = {1000, 1000, 1000, 1000};
    const auto figures = filter_figures(before, after, angles);
    EXPECT_NEAR(figures.rmse, 0.5, 1e-12);
    // Along x, the second differences are 1, 4, 1, 2 before and 0, 2, 0, 2 after.
    EXPECT_NEAR(figures.noise_reduction_x.value(), 1.0 - 1.0 / 1.5, 1e-9);
    EXPECT_NEAR(figures.noise_reduction_y.value(), 0.0, 1e-9);
}

TEST(FilterFigures, FewBeamsHaveNoNoiseReduction) {
    for (std::size_t beams = 0; beams < 3; ++beams) {
        const std::vector<RangeMm> ranges(beams, 1000);
        const auto figures = filter_figures(ranges, ranges, UniformAngles{0.0, 0.1, static_cast<std::uint32_t>(beams)});
        EXPECT_EQ(figures, FilterFigures{});
    }
    const std::vector<RangeMm> none(9, kNoReturn);
    EXPECT_EQ(filter_figures(none, none, UniformAngles{0.0, 0.1, 9}), FilterFigures{});
}

TEST(FullCircle, AcceptsRotatingSensors) {
    EXPECT_TRUE(is_full_circle(UniformAngles{-kPi, 2 * kPi / 360, 360}));
    EXPECT_TRUE(is_full_circle(UniformAngles{kPi, -2 * kPi / 100, 100})); // clockwise
    EXPECT_TRUE(is_full_circle(UniformAngles{0.0, 2 * kPi / 90, 91}));    // the last beam repeats the first direction
    EXPECT_TRUE(is_full_circle(UniformAngles{0.3, 2 * kPi / 16, 16}));
    SteppedAngles turn{2 * kPi / 396'000, {}};
    for (std::int32_t step = 400; step < 396'000; step += 880) turn.steps.push_back(step);
    EXPECT_TRUE(is_full_circle(turn));
    turn.steps.pop_back();
    EXPECT_TRUE(is_full_circle(turn));
    turn.steps.resize(turn.steps.size() - 11); // a lost packet
    EXPECT_FALSE(is_full_circle(turn));
}

TEST(FullCircle, RejectsSensorsWithPartialView) {
    EXPECT_FALSE(is_full_circle(UniformAngles{-kPi / 2, kPi / 683, 684}));
    EXPECT_FALSE(is_full_circle(UniformAngles{-0.75 * kPi, 1.5 * kPi / 1080, 1081}));
    EXPECT_FALSE(is_full_circle(UniformAngles{0.0, kPi, 2}));
    EXPECT_FALSE(is_full_circle(UniformAngles{0.0, 1.0, 1}));
    EXPECT_FALSE(is_full_circle(ExplicitAngles{}));
    EXPECT_FALSE(is_full_circle(ExplicitAngles{0.5, 0.5, 0.5}));
}

} // namespace
} // namespace scanloom::landmarks

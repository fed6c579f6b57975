#include "common/scan/beam_angles.hpp"

#include <gtest/gtest.h>

namespace scanloom {
namespace {

TEST(BeamAngles, UniformAnglesIncreaseByTheIncrement) {
    const BeamAngles angles = UniformAngles{-1.5, 0.25, 13};
    EXPECT_EQ(beam_count(angles), 13U);
    for (std::size_t beam = 0; beam < 13; ++beam) {
        EXPECT_DOUBLE_EQ(beam_angle(angles, beam), -1.5 + 0.25 * static_cast<double>(beam));
    }
}

TEST(BeamAngles, UniformAnglesDecreaseForAClockwiseSensor) {
    const BeamAngles angles = UniformAngles{1.0, -0.5, 3};
    EXPECT_DOUBLE_EQ(beam_angle(angles, 0), 1.0);
    EXPECT_DOUBLE_EQ(beam_angle(angles, 2), 0.0);
}

TEST(BeamAngles, ExplicitAnglesKeepTheirOrder) {
    const BeamAngles angles = ExplicitAngles{0.5, -2.0, 7.0};
    EXPECT_EQ(beam_count(angles), 3U);
    EXPECT_EQ(beam_angle(angles, 0), 0.5);
    EXPECT_EQ(beam_angle(angles, 1), -2.0);
    EXPECT_EQ(beam_angle(angles, 2), 7.0) << "explicit angles are not normalised";
}

TEST(BeamAngles, SteppedAnglesAreMultiplesOfTheirUnit) {
    const BeamAngles angles = SteppedAngles{-0.25, {4, -2, 0, 4}};
    EXPECT_EQ(beam_count(angles), 4U);
    EXPECT_EQ(beam_angle(angles, 0), -1.0);
    EXPECT_EQ(beam_angle(angles, 1), 0.5);
    EXPECT_EQ(beam_angle(angles, 2), 0.0);
    EXPECT_EQ(beam_angle(angles, 3), -1.0) << "each angle is a multiple of the unit, not a sum of differences";
}

TEST(BeamAngles, EmptyAnglesHaveNoBeams) {
    EXPECT_EQ(beam_count(UniformAngles{}), 0U);
    EXPECT_EQ(beam_count(ExplicitAngles{}), 0U);
    EXPECT_EQ(beam_count(SteppedAngles{}), 0U);
}

} // namespace
} // namespace scanloom

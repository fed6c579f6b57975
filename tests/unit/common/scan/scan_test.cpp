#include "common/scan/scan.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace scanloom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(ToRangeMm, RoundsToTheNearestMillimetre) {
    EXPECT_EQ(to_range_mm(1.0), 1000U);
    EXPECT_EQ(to_range_mm(1.2344), 1234U);
    EXPECT_EQ(to_range_mm(1.2346), 1235U);
    EXPECT_EQ(to_range_mm(0.0005), 1U);
    EXPECT_EQ(to_range_mm(81.83), 81830U);
}

TEST(ToRangeMm, NonPositiveOrNanLengthIsInvalid) {
    for (const double no_length : {0.0, -0.0, -1.0, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(to_range_mm(no_length), kInvalidRange) << no_length;
    }
}

TEST(ToRangeMm, LengthBeyondTheMillimetreRangeIsNoReturn) {
    EXPECT_EQ(to_range_mm(4294967.294), 4294967294U);
    for (const double too_long : {4294967.295, 5e6, 1e300, kInfinity}) {
        EXPECT_EQ(to_range_mm(too_long), kNoReturn) << too_long;
    }
}

TEST(ToRangesMm, ConvertsEachReadingIndependently) {
    const std::vector<double> metres = {1.2346, 0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), kInfinity};
    const std::vector<RangeMm> ranges = {1235, kInvalidRange, kInvalidRange, kInvalidRange, kNoReturn};
    EXPECT_EQ(to_ranges_mm(metres), ranges);
    EXPECT_EQ(to_ranges_mm(std::vector<float>(metres.begin(), metres.end())), ranges);
    EXPECT_TRUE(to_ranges_mm(std::vector<float>{}).empty());
}

TEST(AnglesOf, ScanAnglesOverrideSensorAngles) {
    Sensor sensor;
    sensor.angles = UniformAngles{-1.0, 0.1, 20};
    Scan scan;
    scan.ranges = {1, 2};
    scan.angles = ExplicitAngles{0.5, 0.25};
    EXPECT_EQ(angles_of(scan, sensor), BeamAngles(ExplicitAngles{0.5, 0.25}));
}

TEST(AnglesOf, UniformSensorAnglesFitAnyNumberOfRanges) {
    Sensor sensor;
    sensor.angles = UniformAngles{-1.0, 0.1, 20};
    for (const std::size_t beams : {1U, 19U, 20U, 21U, 60U}) {
        Scan scan;
        scan.ranges.assign(beams, 1000);
        EXPECT_EQ(angles_of(scan, sensor), BeamAngles(UniformAngles{-1.0, 0.1, static_cast<std::uint32_t>(beams)}));
    }
}

TEST(AnglesOf, ExplicitSensorAnglesAreUsedUnchanged) {
    Sensor sensor;
    sensor.angles = ExplicitAngles{0.3, -0.2, 0.1};
    Scan scan;
    scan.ranges = {1, 2, 3};
    EXPECT_EQ(angles_of(scan, sensor), sensor.angles);
    sensor.angles = SteppedAngles{0.1, {3, -2, 1}};
    EXPECT_EQ(angles_of(scan, sensor), sensor.angles);
}

} // namespace
} // namespace scanloom

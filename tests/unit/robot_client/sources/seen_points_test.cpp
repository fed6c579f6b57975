#include "robot_client/sources/seen_points.hpp"

#include "common/scan/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace scanloom::robot {
namespace {

using testing::ElementsAre;

Sensor mounted_laser() {
    Sensor sensor;
    sensor.angles = UniformAngles{0.0, std::numbers::pi / 2, 4};
    sensor.range_min = 0.1;
    sensor.range_max = 10.0;
    return sensor;
}

Scan scan_of(std::vector<RangeMm> ranges, const Pose2& pose = {}) {
    Scan scan;
    scan.pose = pose;
    scan.ranges = std::move(ranges);
    return scan;
}

TEST(PointsSeen, AreTheEndsOfReturningBeams) {
    SeenPoints seen;
    seen.add(scan_of({1000, kInvalidRange, 2000, kNoReturn}), mounted_laser());
    seen.add(scan_of({99, 10'000, 9999, 100}), mounted_laser());
    EXPECT_THAT(seen.points(), ElementsAre(PointMm{1000, 0}, PointMm{-2000, 0}, PointMm{-9999, 0}, PointMm{0, -100}));
    EXPECT_EQ(seen.from(), (Point2{0.0, 0.0}));
}

TEST(PointsSeen, AreInTheFrameOfThePoses) {
    Sensor mounted = mounted_laser();
    mounted.mount = {0.5, 0.0, std::numbers::pi / 2};
    SeenPoints seen;
    seen.add(scan_of({1000, 0, 0, 0}, {1.0, 2.0, std::numbers::pi / 2}), mounted);
    EXPECT_THAT(seen.points(), ElementsAre(PointMm{0, 2500}));
    EXPECT_LT(norm(seen.from() - Point2{1.0, 2.5}), 1e-12);
    seen.add(scan_of({0, 0, 0, 0}, {2.0, 2.0, std::numbers::pi / 2}), mounted);
    EXPECT_LT(norm(seen.from() - Point2{1.5, 2.5}), 1e-12) << "between the sensor's positions";
}

TEST(PointsSeen, AreInTheFrameOfTheOdometryWithoutAPose) {
    Scan scan = scan_of({1000, 0, 0, 0});
    scan.pose.reset();
    SeenPoints at_the_origin;
    at_the_origin.add(scan, mounted_laser());
    EXPECT_THAT(at_the_origin.points(), ElementsAre(PointMm{1000, 0}));
    scan.odometry = Pose2{1.0, 2.0, 0.0};
    SeenPoints seen;
    seen.add(scan, mounted_laser());
    EXPECT_THAT(seen.points(), ElementsAre(PointMm{2000, 2000}));
}

TEST(PointsSeen, ExcludePointsBeyondTheCoordinateLimit) {
    SeenPoints seen;
    seen.add(scan_of({1000, 1000, 1000, 1000}, {1e6 - 0.5, 0.0, 0.0}), mounted_laser());
    EXPECT_EQ(seen.points().size(), 3U);
}

TEST(PointsSeen, AreThinnedEvenly) {
    SeenPoints seen;
    const std::size_t scans = 3 * kViewPointsMax / 4;
    for (std::size_t n = 0; n < scans; ++n) {
        seen.add(scan_of({1000, 1000, 1000, 1000}, {static_cast<double>(n), 0.0, 0.0}), mounted_laser());
    }
    const auto points = seen.points();
    ASSERT_EQ(points.size(), kViewPointsMax);
    for (std::size_t n = 1; n < points.size(); ++n) {
        EXPECT_LE(std::abs(points[n].x - points[n - 1].x), 3000) << "at least every third point is kept";
    }
    EXPECT_GT(points.back().x, 1000 * (static_cast<std::int32_t>(scans) - 3));
}

} // namespace
} // namespace scanloom::robot

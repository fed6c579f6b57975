#include "core/scan_matching/scan_points.hpp"
#include "tests/support/building.hpp"

#include <gtest/gtest.h>

#include <random>

namespace scanloom::scan_matching {
namespace {

using testing_support::Building;

ScanPoints points_in(const Building& building, const Sensor& sensor, const Pose2& pose, double noise_m = 0.0) {
    std::mt19937 random(1);
    return points_of(building.scan(sensor, pose, noise_m, random), sensor);
}

TEST(ScanPoints, PointsLieOnTheWallAndNormalsPointToTheLaser) {
    Building building;
    building.walls = {{{3.0, -10.0}, {3.0, 10.0}}};
    const auto points = points_in(building, Building::laser(), {0.0, 0.0, 0.0}).points;
    ASSERT_GT(points.size(), 140U);
    for (const auto& point : points) {
        EXPECT_NEAR(point.x, 3.0, 1e-3);
        if (!point.has_normal()) continue; // far out, where beams are far apart
        EXPECT_NEAR(point.normal_x, -1.0, 1e-2);
        EXPECT_NEAR(point.normal_y, 0.0, 0.1);
    }
    EXPECT_TRUE(points[points.size() / 2].has_normal());
}

TEST(ScanPoints, NormalsNearACornerAreThoseOfItsWalls) {
    Building building;
    building.walls = {{{2.0, 0.0}, {2.0, 5.0}}, {{2.0, 0.0}, {7.0, 0.0}}};
    building.add_box(1.0, -1.02, 1.02, -1.0); // a post that few beams hit
    const auto [s, c] = sin_cos(1.0);         // the robot's yaw
    std::size_t with_normal = 0;
    for (const auto& point : points_in(building, Building::laser(), {0.0, -2.0, 1.0}).points) {
        if (!point.has_normal()) continue;
        ++with_normal;
        const double x = c * point.normal_x - s * point.normal_y; // in the map's frame
        const double y = s * point.normal_x + c * point.normal_y;
        EXPECT_TRUE(x < -0.95 || y < -0.95) << x << ", " << y;
        EXPECT_GT(std::hypot(point.x, point.y), 1.5) << "the post has no normal";
    }
    EXPECT_GT(with_normal, 30U);
}

TEST(ScanPoints, TheMountMovesAndTurnsThePoints) {
    Building building;
    building.walls = {{{3.0, -10.0}, {3.0, 10.0}}};
    Sensor sensor = Building::laser();
    sensor.mount = {0.5, 0.25, -0.75};
    const auto shown = points_in(building, sensor, {0.0, 0.0, 0.0});
    EXPECT_EQ(shown.laser, (Point2{0.5, 0.25}));
    ASSERT_FALSE(shown.points.empty());
    for (const auto& point : shown.points) EXPECT_NEAR(point.x, 3.0, 1e-3);
    EXPECT_NEAR(shown.points[120].normal_x, -1.0, 1e-2);
}

/// The memory of maps grows with the distance of points from the robot.
TEST(ScanPoints, ALaserFarFromItsRobotHasNoPoints) {
    Building building;
    building.walls = {{{3.0, -10.0}, {3.0, 10.0}}};
    const auto points_from = [&](double x) {
        const Scan scan = [&] {
            std::mt19937 random(1);
            return building.scan(Building::laser(), {0.0, 0.0, 0.0}, 0.0, random);
        }();
        Sensor mounted = Building::laser();
        mounted.mount = {x, 0.0, 0.0};
        return points_of(scan, mounted);
    };
    EXPECT_FALSE(points_from(kMountDistanceMax).points.empty());
    EXPECT_TRUE(are_in_reach(points_from(kMountDistanceMax)));
    EXPECT_TRUE(points_from(kMountDistanceMax + 0.01).points.empty());
    EXPECT_TRUE(points_from(-1e6).points.empty());
    EXPECT_TRUE(are_in_reach(points_from(-1e6)));
    EXPECT_FALSE(are_in_reach({{{.x = 0.0F, .y = 51.0F}}, {0.0, 0.0}}));
    EXPECT_FALSE(are_in_reach({{}, {0.0, 21.0}}));
}

TEST(ScanPoints, ReadingsWithoutAReturnAreLeftOut) {
    const Sensor sensor = Building::laser();
    Scan scan;
    scan.ranges.assign(181, kNoReturn);
    scan.ranges[3] = kInvalidRange;
    scan.ranges[4] = 20;     // below range_min
    scan.ranges[5] = 25'000; // at or beyond range_max
    EXPECT_TRUE(points_of(scan, sensor).points.empty());
    scan.ranges[90] = 2'000;
    const auto points = points_of(scan, sensor).points;
    ASSERT_EQ(points.size(), 1U);
    EXPECT_NEAR(points[0].x, 2.0, 1e-6);
    EXPECT_FALSE(points[0].has_normal());
}

/// A URG-04LX along a corridor: beams are 1 cm apart, and readings have a noise of 2 cm. Normals along the corridor
/// would hold the robot back.
TEST(ScanPoints, NormalsOfDenseAndNoisyBeamsAreThoseOfTheWalls) {
    Sensor laser;
    laser.angles = UniformAngles{-1.5708, 0.0046, 684};
    laser.range_max = 5.0;
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0.0, 0.02);
    std::normal_distribution<double> direction(0.0, 0.005);
    Scan scan;
    for (std::size_t n = 0; n < 684; ++n) {
        const double angle = beam_angle(laser.angles, n) + direction(random);
        const double range = 1.2 / std::fabs(std::sin(angle)); // walls at y = -1.2 and 1.2
        scan.ranges.push_back(range < 4.9 ? to_range_mm(range + noise(random)) : kNoReturn);
    }
    const auto points = points_of(scan, laser).points;
    double along = 0.0; // information about the position along the corridor, which the scan does not have
    double across = 0.0;
    for (const SurfacePoint& point : points) {
        along += point.normal_x * point.normal_x;
        across += point.normal_y * point.normal_y;
    }
    EXPECT_GT(across, 0.7 * static_cast<double>(points.size())) << "most points have a normal";
    EXPECT_LT(along, 0.01 * across);
}

/// Beams that graze a wall hit it at places that are metres apart. Matched to points, they would hold the robot back.
TEST(ScanPoints, NormalsOfGrazedWallsAreThoseOfTheWalls) {
    Building corridor;
    corridor.walls = {{{-100.0, -1.0}, {100.0, -1.0}}, {{-100.0, 1.0}, {100.0, 1.0}}};
    const auto points = points_in(corridor, Building::laser(), {0.0, 0.0, 0.0}, 0.01).points;
    ASSERT_GT(points.size(), 170U);
    EXPECT_GT(std::fabs(points[87].x - points[86].x), 2.0) << "metres apart";
    for (const SurfacePoint& point : points) {
        EXPECT_NEAR(point.normal_y, point.y > 0.0 ? -1.0 : 1.0, 0.02) << point.x << ", " << point.y;
    }
}

TEST(ScanPoints, ManyBeamsAreThinnedEvenly) {
    Sensor sensor = Building::laser();
    sensor.angles = UniformAngles{-1.5, 3.0 / 1999, 2000};
    Scan scan;
    scan.ranges.assign(2000, 3'000);
    const auto points = points_of(scan, sensor).points;
    EXPECT_EQ(points.size(), kScanPointsMax);
    const double angle = std::atan2(points.back().y, points.back().x);
    EXPECT_NEAR(angle, 1.5, 5 * 3.0 / 1999);
}

} // namespace
} // namespace scanloom::scan_matching

#include "lab/recording.hpp"

#include "lab/door_room.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace scanloom::lab {
namespace {

constexpr double kRight = std::numbers::pi / 2.0;

Sensor cross() {
    Sensor sensor;
    sensor.angles = UniformAngles{0.0, kRight, 4};
    sensor.range_min = 0.1;
    sensor.range_max = 5.0;
    sensor.mount = {0.5, 0.0, 0.0};
    return sensor;
}

void expect_near(const Point2& point, double x, double y) {
    EXPECT_NEAR(point.x, x, 1e-9);
    EXPECT_NEAR(point.y, y, 1e-9);
}

TEST(LidarCaptures, PointsAreBeamEndsRelativeToTheMount) {
    Scan scan;
    scan.ranges = {1000, kInvalidRange, 2000, kNoReturn};
    scan.pose = {10.0, 20.0, kRight};
    const std::vector<Scan> scans{scan};
    const auto points = points_of(scans, cross());
    ASSERT_EQ(points.size(), 2U);
    expect_near(points[0], 1.5, 0.0);
    expect_near(points[1], -1.5, 0.0);
    const auto in_map = points_in_map(scans, cross());
    ASSERT_EQ(in_map.size(), 2U);
    expect_near(in_map[0], 10.0, 21.5);
    expect_near(in_map[1], 10.0, 18.5);
}

TEST(LidarCaptures, ReadingsOutsideTheSensorsLimitsGiveNoPoints) {
    Scan scan;
    scan.ranges = {99, 100, 4999, 5000};
    EXPECT_EQ(points_of(std::vector<Scan>{scan}, cross()).size(), 2U);
}

TEST(LidarCaptures, AreDeterministicTurnsFromOnePlace) {
    const auto world = make_door_room(Door::kClosed);
    const Pose2 place{3.0, 2.7, 0.0};
    sim::Random first(5);
    sim::Random second(5);
    const auto capture = take_capture(world, place, 3, sim::Noise{}, first);
    EXPECT_EQ(capture.scans, take_capture(world, place, 3, sim::Noise{}, second).scans);
    ASSERT_EQ(capture.scans.size(), 3U);
    EXPECT_EQ(capture.scans[2].seq, 3U);
    EXPECT_EQ(capture.scans[2].pose, place);
    EXPECT_NEAR(capture.scans[2].stamp, 0.2, 1e-9);
    EXPECT_NE(capture.scans[0].ranges, capture.scans[1].ranges) << "the turns differ by noise";
    const auto exact = take_capture(world, place, 1, std::nullopt, first);
    EXPECT_EQ(exact.scans[0].ranges[180], 2080U) << "the beam ahead reaches the door";
}

} // namespace
} // namespace scanloom::lab

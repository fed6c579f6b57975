#include "core/scan_matching/deskew.hpp"
#include "tests/support/building.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace scanloom::scan_matching {
namespace {

using testing_support::Building;

constexpr double kSpeed = 1.2;  // metres per second, of the robot
constexpr double kDrift = -0.3; // metres per second, sideways
constexpr double kTurn = 1.5;   // radians per second

Building room() {
    Building building;
    building.add_box(-4.0, -3.0, 5.0, 3.5);
    building.add_box(1.0, 1.5, 1.6, 2.0);
    return building;
}

Sensor lidar() {
    Sensor sensor;
    sensor.angles = UniformAngles{-std::numbers::pi, std::numbers::pi / 180.0, 360};
    sensor.mount = {0.2, -0.1, 0.7};
    sensor.range_max = 6.0;
    return sensor;
}

/// Returns where the robot is at a time, by the closed form of its arc: T_map_robot. It is at (0.5, 0.2, 0.3) at 0 s.
Pose2 pose_at(double seconds) {
    const double yaw = kTurn * seconds;
    const double s = std::sin(yaw) / kTurn;
    const double c = (1.0 - std::cos(yaw)) / kTurn;
    return compose({0.5, 0.2, 0.3}, {kSpeed * s - kDrift * c, kSpeed * c + kDrift * s, yaw});
}

/// What a lidar measures that turns while the robot moves. The hits are exact.
struct MovingScan {
    Scan scan;
    std::vector<Point2> hits; ///< map frame
};

/// Takes each beam from where the robot is at its time. The stamp is 0 s.
MovingScan scan_from_moving(const Sensor& sensor, double duration) {
    const Building building = room();
    MovingScan taken;
    taken.scan.duration = duration;
    const std::size_t count = beam_count(sensor.angles);
    for (std::size_t n = 0; n < count; ++n) {
        const double seconds = duration * (static_cast<double>(n) / static_cast<double>(count - 1) - 0.5);
        const Pose2 laser = compose(pose_at(seconds), sensor.mount);
        const double yaw = laser.yaw + beam_angle(sensor.angles, n);
        const double range = building.range({laser.x, laser.y}, {std::sin(yaw), std::cos(yaw)});
        taken.scan.ranges.push_back(range < sensor.range_max ? to_range_mm(range) : kNoReturn);
        taken.hits.push_back({laser.x + range * std::cos(yaw), laser.y + range * std::sin(yaw)});
    }
    return taken;
}

/// Returns the largest distance of the hits of `scan`, seen from the pose at its stamp, from the true ones. Metres.
double largest_error(const Scan& scan, const MovingScan& taken, const Sensor& sensor) {
    const Pose2 laser = compose(pose_at(0.0), sensor.mount);
    const BeamAngles angles = angles_of(scan, sensor);
    double largest = 0.0;
    for (std::size_t n = 0; n < scan.ranges.size(); ++n) {
        if (taken.scan.ranges[n] == kNoReturn) continue;
        const double range = scan.ranges[n] * 1e-3;
        const double angle = beam_angle(angles, n);
        const Point2 hit = transform(laser, {range * std::cos(angle), range * std::sin(angle)});
        largest = std::max(largest, std::hypot(hit.x - taken.hits[n].x, hit.y - taken.hits[n].y));
    }
    return largest;
}

Motion motion_over(double seconds) { return {compose(inverse(pose_at(-seconds)), pose_at(0.0)), seconds}; }

TEST(Deskew, HitsAreWhereTheirBeamsHit) {
    const Sensor sensor = lidar();
    for (const double duration : {0.1, -0.1}) {
        const auto taken = scan_from_moving(sensor, duration);
        EXPECT_GT(largest_error(taken.scan, taken, sensor), 0.3) << "as taken";
        for (const double seconds : {0.1, 0.2}) {
            ASSERT_TRUE(can_deskew(taken.scan, sensor, motion_over(seconds)));
            const Scan still = deskewed(taken.scan, sensor, motion_over(seconds));
            EXPECT_LT(largest_error(still, taken, sensor), 0.002) << duration << " " << seconds;
            EXPECT_EQ(still.duration, 0.0);
        }
    }
}

TEST(Deskew, BeamsWithoutAReturnAreTurned) {
    const Sensor sensor = lidar();
    MovingScan taken = scan_from_moving(sensor, 0.1);
    taken.scan.ranges[0] = kNoReturn;
    taken.scan.ranges[359] = kInvalidRange;
    const Scan still = deskewed(taken.scan, sensor, motion_over(0.1));
    EXPECT_EQ(still.ranges[0], kNoReturn);
    EXPECT_EQ(still.ranges[359], kInvalidRange);
    EXPECT_NEAR(beam_angle(*still.angles, 0), -std::numbers::pi - 0.05 * kTurn, 1e-9);
    EXPECT_NEAR(beam_angle(*still.angles, 359), 179.0 / 180.0 * std::numbers::pi + 0.05 * kTurn, 1e-9);
}

TEST(Deskew, MissingBeamsDoNotChangeTheTimesOfOthers) {
    const Sensor sensor = lidar();
    MovingScan taken = scan_from_moving(sensor, 0.1);
    ExplicitAngles angles;
    MovingScan part{taken.scan, {}};
    part.scan.ranges.clear();
    for (std::size_t n = 0; n < 360; ++n) {
        if (n > 40 && n < 140) continue; // a lost packet
        angles.push_back(beam_angle(sensor.angles, n));
        part.scan.ranges.push_back(taken.scan.ranges[n]);
        part.hits.push_back(taken.hits[n]);
    }
    part.scan.angles = angles;
    EXPECT_LT(largest_error(deskewed(part.scan, sensor, motion_over(0.1)), part, sensor), 0.002);
}

TEST(Deskew, NeedsTimesAndAMotion) {
    const Sensor sensor = lidar();
    const Scan scan = scan_from_moving(sensor, 0.1).scan;
    const Motion motion = motion_over(0.1);
    EXPECT_TRUE(can_deskew(scan, sensor, motion));
    Scan at_once = scan;
    at_once.duration = 0.0;
    EXPECT_FALSE(can_deskew(at_once, sensor, motion));
    Scan disordered = scan;
    ExplicitAngles angles;
    for (std::size_t n = 0; n < 360; ++n) angles.push_back(beam_angle(sensor.angles, n));
    disordered.angles = angles;
    EXPECT_TRUE(can_deskew(disordered, sensor, motion));
    std::swap(angles[7], angles[8]);
    disordered.angles = angles;
    EXPECT_FALSE(can_deskew(disordered, sensor, motion));
    Sensor sonar = sensor;
    sonar.kind = SensorKind::kSonar;
    EXPECT_FALSE(can_deskew(scan, sonar, motion));
    for (const double seconds : {0.0, -0.1, 1.5}) {
        EXPECT_FALSE(can_deskew(scan, sensor, {motion.T_before_now, seconds})) << seconds;
    }
    EXPECT_FALSE(can_deskew(scan, sensor, {{1.1, 0.0, 0.0}, 0.1})) << "another place";
    EXPECT_FALSE(can_deskew(scan, sensor, {{0.0, 0.0, -1.1}, 0.1}));
}

} // namespace
} // namespace scanloom::scan_matching

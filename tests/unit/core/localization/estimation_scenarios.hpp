#pragma once

#include "tests/unit/core/localization/growing_log.hpp"
#include "tests/unit/core/slam/other_buildings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

/// Scenarios of estimation_state_test.cpp: what robots do while their log grows.
namespace scanloom::localization {

inline const slam::Drive& looped() {
    static const slam::Drive drive =
        slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    return drive;
}

inline const slam::Drive& way_back() {
    static const slam::Drive drive = slam::drive_along(
        slam::ring_building(), std::vector<Point2>{{24.0, 21.0}, {1.0, 21.0}, {1.0, 8.0}}, {.scale = 0.98}, 2);
    return drive;
}

/// Loops, which correct the maps.
inline void drive_a_lap(GrowingLog& log) {
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < looped().scans.size(); ++n) log.drive(0, looped(), n, Poses::kOdometry);
}

/// Two robots: one without odometry that also has sonars, and one that starts elsewhere, sees nothing for a while, and
/// is lost then.
inline void drive_two_robots(GrowingLog& log) {
    Sensor sonar;
    sonar.id = 7;
    sonar.kind = SensorKind::kSonar;
    sonar.range_max = 3.0;
    sonar.aperture = 0.4;
    sonar.angles = UniformAngles{0.0, 0.1, 1};
    slam::Drive readings = looped();
    for (Scan& scan : readings.scans) {
        scan.sensor = 7;
        scan.ranges = {1000};
    }
    log.join(0, looped(), Poses::kNone);
    log.add(SensorDescribed{0, sonar});
    for (std::size_t n = 0; n < 900; ++n) {
        log.drive(0, looped(), n, Poses::kNone);
        if (n % 3 == 0) log.drive(0, readings, n, Poses::kNone);
    }
    log.join(1, way_back(), Poses::kOdometry);
    slam::Drive blind = way_back();
    for (Scan& scan : blind.scans) std::ranges::fill(scan.ranges, kNoReturn);
    for (std::size_t n = 0; n < way_back().scans.size(); ++n) {
        log.drive(0, looped(), 900 + n % 200, Poses::kNone);
        log.drive(1, n > 250 && n < 290 ? blind : way_back(), n, Poses::kOdometry);
    }
}

/// Localize-only mode while a robot goes on beyond the map, a robot that an operator looks for, and mapping afterwards.
inline void drive_in_a_frozen_map(GrowingLog& log) {
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < 400; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    log.add(ModeChanged{true});
    for (std::size_t n = 400; n < 700; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    log.join(1, looped(), Poses::kOdometry);
    for (std::size_t n = 200; n < 300; ++n) {
        if (n == 203 || n == 270) {
            const Pose2 truth = compose(inverse(looped().truth.front()), looped().truth[n]);
            log.add(RobotRelocalized{1, {truth.x + 1.0, truth.y}, 4.0});
        }
        log.drive(1, looped(), n, Poses::kOdometry);
    }
    log.add(ModeChanged{false});
    for (std::size_t n = 700; n < 900; ++n) log.drive(0, looped(), n, Poses::kOdometry);
    for (std::size_t n = 300; n < 400; ++n) log.drive(1, looped(), n, Poses::kOdometry);
}

/// A robot that is located in the map of one that sends its poses.
inline void follow_a_sender(GrowingLog& log) {
    log.join(0, looped(), Poses::kMap);
    for (std::size_t n = 0; n < 700; ++n) log.drive(0, looped(), n, Poses::kMap);
    log.join(1, looped(), Poses::kNone);
    for (std::size_t n = 700; n < 1000; ++n) {
        log.drive(0, looped(), n, Poses::kMap);
        log.drive(1, looped(), n - 500, Poses::kNone);
        if (n == 900) log.join(2, looped(), Poses::kMap);
        if (n > 900) log.drive(2, looped(), n - 600, Poses::kMap);
    }
}

/// A robot with a wrong mount that is located in a map that does not change, of one that sends its poses.
inline void look_for_a_place_in_a_complete_map(GrowingLog& log) {
    log.join(0, looped(), Poses::kMap);
    for (std::size_t n = 0; n < 700; ++n) log.drive(0, looped(), n, Poses::kMap);
    log.add(ModeChanged{true});
    slam::Drive turned = looped();
    turned.laser.mount.yaw = 0.6; // it is 0
    log.join(1, turned, Poses::kOdometry);
    for (std::size_t n = 200; n < 350; ++n) log.drive(1, turned, n, Poses::kOdometry);
    EXPECT_TRUE(log.maps().localization_of(1).mount_yaw_error);
}

/// A robot in another building, where a search of its place takes several parts.
inline void drive_in_another_building(GrowingLog& log) {
    const slam::Drive& drive = slam::drive_in_other_building();
    log.join(0, looped(), Poses::kOdometry);
    for (std::size_t n = 0; n < looped().scans.size(); n += 2) log.drive(0, looped(), n, Poses::kOdometry);
    log.join(1, drive, Poses::kOdometry);
    for (std::size_t n = 0; n < 100; ++n) log.drive(1, drive, n, Poses::kOdometry);
}

/// A straight corridor whose posts are the same in every 30 m, with exact odometry.
inline slam::Drive repeating_corridor(double length) {
    constexpr double kPeriod = 30.0;
    testing_support::Building part; // all that is seen from its first period
    part.walls = {{{-40.0, -1.0}, {70.0, -1.0}}, {{-40.0, 1.5}, {70.0, 1.5}}};
    for (const double at : {2.0, 4.7, 9.1, 11.9, 18.3, 21.4, 25.8}) {
        for (const double shift : {-kPeriod, 0.0, kPeriod}) part.add_box(at + shift, -1.0, at + shift + 0.5, -0.6);
    }
    slam::Drive drive;
    std::mt19937 random(6);
    for (double at = 0.0; at < length; at += 0.5) {
        drive.truth.push_back({at, 0.0, 0.0});
        drive.odometry.push_back({at, 0.0, 0.0});
        drive.scans.push_back(part.scan(drive.laser, {std::fmod(at, kPeriod), 0.0, 0.0}, 0.01, random));
    }
    return drive;
}

/// A robot that goes on for more than a kilometre beyond a map that does not change, by what it sees itself.
inline void drive_far_beyond_a_frozen_map(GrowingLog& log) {
    static const slam::Drive drive = repeating_corridor(1300.0);
    log.join(0, drive, Poses::kOdometry);
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        if (n == 100) log.add(ModeChanged{true});
        log.drive(0, drive, n, Poses::kOdometry);
    }
    EXPECT_EQ(log.maps().localization_of(0).state, LocalizationState::kTracking);
    EXPECT_NEAR(log.maps().poses().find(0)->location().T_map_robot.x, drive.truth.back().x, 5.0);
}

/// A sender that is wrong by kilometres now and then, a robot that is located in its map, and lasers that are too far
/// from their robots.
inline void drive_with_impossible_distances(GrowingLog& log) {
    slam::Drive jumping = looped();
    for (std::size_t n = 50; n < jumping.truth.size(); n += 100) jumping.truth[n].x += 1500.0;
    log.join(0, jumping, Poses::kMap);
    for (std::size_t n = 0; n < 20; ++n) log.drive(0, jumping, n, Poses::kMap);
    log.join(1, looped(), Poses::kOdometry);
    for (std::size_t n = 20; n < 700; ++n) {
        log.drive(0, jumping, n, Poses::kMap);
        if (n >= 300 && n < 600) log.drive(1, looped(), n - 100, Poses::kOdometry);
    }
    EXPECT_EQ(log.maps().localization_of(1).state, LocalizationState::kTracking);
    slam::Drive far = looped();
    far.laser.mount = {1200.0, 0.0, 0.0};
    log.join(2, far, Poses::kOdometry);
    log.join(3, far, Poses::kMap);
    for (std::size_t n = 0; n < 60; ++n) {
        log.drive(2, far, n, Poses::kOdometry);
        log.drive(3, far, n, Poses::kMap);
    }
}

} // namespace scanloom::localization

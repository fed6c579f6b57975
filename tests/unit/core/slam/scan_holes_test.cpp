#include "core/slam/trajectory_estimator.hpp"
#include "tests/unit/core/slam/other_buildings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

/// Times without scans, or with scans that show nothing new.
namespace scanloom::slam {
namespace {

using testing_support::Building;

/// A robot without odometry is carried to another floor while there are no scans.
TEST(ScanHoles, BeginAFragmentWithoutOdometryUnlessTheScanFits) {
    const Building building = ring_building();
    const Sensor laser = Building::laser();
    for (const double seconds : {0.5, 2.0, 20.0}) {
        for (const bool has_moved : {false, true}) {
            SCOPED_TRACE(testing::Message() << seconds << " s, " << has_moved);
            std::mt19937 random(9);
            LoneEstimator estimator;
            const auto add = [&](const Building& around, const Pose2& pose, double since) {
                estimator->add(scan_matching::points_of(around.scan(laser, pose, 0.01, random), laser), std::nullopt,
                               since);
            };
            for (int n = 0; n < 40; ++n) add(building, {5.0 + 0.1 * n, 1.0, 0.0}, 0.2);
            add(has_moved ? other_building() : building, {9.0, 1.0, 0.0}, seconds);
            const bool must_begin = has_moved && seconds > 1.0;
            EXPECT_EQ(estimator.map->graph().fragments().size(), must_begin ? 2U : 1U);
            EXPECT_EQ(estimator->needs_place(), must_begin);
            EXPECT_EQ(estimator->was_located(40), !has_moved);
        }
    }
}

/// A robot without odometry is carried to another floor while its driver sends the last scan again and again, or scans
/// of nothing.
TEST(ScanHoles, AreScansThatShowNothingNew) {
    const Building building = ring_building();
    const Sensor laser = Building::laser();
    for (const bool is_repeated : {false, true}) {
        for (const bool has_moved : {false, true}) {
            SCOPED_TRACE(testing::Message() << is_repeated << has_moved);
            std::mt19937 random(9);
            LoneEstimator estimator;
            double stamp = 0.0;
            const auto add = [&](Scan scan) {
                scan.stamp = stamp += 0.2;
                estimator->add(scan, laser);
            };
            Scan scan;
            for (int n = 0; n < 40; ++n) add(scan = building.scan(laser, {5.0 + 0.1 * n, 1.0, 0.0}, 0.01, random));
            if (!is_repeated) scan.ranges.assign(scan.ranges.size(), kNoReturn);
            for (int n = 0; n < 15; ++n) add(scan);
            const Building around = has_moved ? other_building() : building;
            add(around.scan(laser, {9.0, 1.0, 0.0}, 0.01, random));
            EXPECT_EQ(estimator->was_located(55), !has_moved);
            for (int n = 0; n < 40; ++n) add(around.scan(laser, {9.0, 1.0, 0.0}, 0.01, random));
            EXPECT_EQ(estimator.map->graph().fragments().size(), has_moved ? 2U : 1U);
        }
    }
}

/// A simulated robot without noise stands for a minute and takes equal scans. Then somebody stands in front of a third
/// of the beams.
TEST(ScanHoles, AreNotEqualScansOfAStandingRobot) {
    const Building building = ring_building();
    const Sensor laser = Building::laser();
    for (const bool has_odometry : {false, true}) {
        SCOPED_TRACE(has_odometry);
        std::mt19937 random(9);
        LoneEstimator estimator;
        double stamp = 0.0;
        const auto add = [&](Scan scan, const Pose2& pose) {
            scan.stamp = stamp += 0.2;
            if (has_odometry) scan.odometry = pose;
            estimator->add(scan, laser);
        };
        Pose2 pose{5.0, 1.0, 0.0};
        Scan scan;
        for (int n = 0; n < 40; ++n, pose.x += 0.1) add(scan = building.scan(laser, pose, 0.01, random), pose);
        pose.x -= 0.1;
        for (int n = 0; n < 300; ++n) add(scan, pose);
        for (std::size_t beam = 60; beam < 120; ++beam) scan.ranges[beam] = 400;
        for (int n = 0; n < 3; ++n) add(scan, pose);
        for (int n = 0; n < 20; ++n, pose.x += 0.1) add(building.scan(laser, pose, 0.01, random), pose);
        EXPECT_FALSE(estimator->needs_place());
        EXPECT_EQ(estimator.map->graph().fragments().size(), 1U);
    }
}

/// Between equal walls, a laser without noise sees the same wherever it is.
TEST(ScanHoles, EqualScansOfAMovingRobotFollowItsOdometry) {
    Building corridor;
    corridor.add_box(-100.0, 0.0, 200.0, 2.0);
    Sensor laser = Building::laser();
    laser.range_max = 5.0;
    std::mt19937 random(9);
    LoneEstimator estimator;
    for (int n = 0; n < 100; ++n) {
        const Pose2 pose{0.1 * n, 1.0, 0.0};
        Scan scan = corridor.scan(laser, pose, 0.0, random);
        scan.stamp = 0.2 * n;
        scan.odometry = pose;
        estimator->add(scan, laser);
    }
    EXPECT_TRUE(estimator->was_located(99));
    EXPECT_NEAR(estimator->first_pose_of(99).x - estimator->first_pose_of(0).x, 9.9, 0.5);
}

/// The driver sends each scan four times, and the odometry says that the robot moves meanwhile.
TEST(ScanHoles, RepeatedScansFollowTheOdometry) {
    Drive drive = drive_along(ring_building(), std::vector<Point2>{{5.0, 1.0}, {13.0, 1.0}}, {}, 12);
    for (std::size_t n = 0; n < drive.scans.size(); ++n) drive.scans[n].ranges = drive.scans[n - n % 4].ranges;
    SharedMap map;
    TrajectoryEstimator estimator(map);
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.odometry = drive.odometry[n];
        estimator.add(scan, drive.laser);
    }
    estimator.finish();
    double worst = 0.0;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        const Pose2 off =
            compose(inverse(drive.truth[n]),
                    compose(drive.truth[0], compose(inverse(estimator.pose_of(0)), estimator.pose_of(n))));
        worst = std::max(worst, std::hypot(off.x, off.y));
    }
    EXPECT_LT(worst, 0.1);
}

TEST(ScanHoles, AreCrossedWithOdometryUnlessItStartedAgain) {
    const auto moved_by = [](const Pose2& before, const Pose2& after, double seconds) {
        SharedMap map;
        TrajectoryEstimator estimator(map);
        estimator.add({}, before);
        estimator.add({}, after, seconds);
        estimator.finish();
        return estimator.pose_of(1).x - estimator.pose_of(0).x;
    };
    EXPECT_NEAR(moved_by({5.0, 0.0, 0.0}, {14.0, 0.0, 0.0}, 0.2), 9.0, 1e-9);
    EXPECT_NEAR(moved_by({5.0, 0.0, 0.0}, {25.0, 0.0, 0.0}, 0.2), 0.0, 1e-9) << "100 m/s";
    EXPECT_NEAR(moved_by({5.0, 0.0, 0.0}, {25.0, 0.0, 0.0}, 15.0), 20.0, 1e-9);
    EXPECT_NEAR(moved_by({25.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, 60.0), 0.0, 1e-9) << "the robot was switched on again";
}

} // namespace
} // namespace scanloom::slam

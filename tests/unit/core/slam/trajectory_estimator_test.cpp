#include "core/slam/trajectory_estimator.hpp"
#include "tests/unit/core/slam/other_buildings.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <map>

namespace scanloom::slam {
namespace {

using testing_support::Building;

const std::vector<Point2> kTwoLaps{{10.0, 1.0}, {33.0, 1.0}, {33.0, 21.0}, {1.0, 21.0},
                                   {1.0, 1.0},  {33.0, 1.0}, {33.0, 21.0}, {20.0, 21.0}};

double error_of(const Drive& drive, const LoneEstimator& estimator) {
    return largest_error(drive, [&](std::size_t n) { return estimator->pose_of(n); });
}

TEST(TrajectoryEstimator, LoopClosuresCorrectOdometryDrift) {
    const Drive drive = drive_along(ring_building(), kTwoLaps, {.scale = 1.03, .turn = 0.004}, 1);
    EXPECT_GT(largest_error(drive, [&](std::size_t n) { return drive.odometry[n]; }), 5.0);
    const auto estimator = estimated(drive, true);
    EXPECT_LT(error_of(drive, estimator), 0.15);
    EXPECT_GT(estimator.map->loop_figures().loops, 10U);
    EXPECT_GT(estimator.map->optimization_count(), estimator.map->loop_figures().stretches_accepted);
    EXPECT_EQ(estimator->unmatched_count(), 0U);
    EXPECT_EQ(estimator->scan_count(), drive.scans.size());
}

TEST(TrajectoryEstimator, EstimatesARingWithoutOdometry) {
    const Drive drive = drive_along(ring_building(), kTwoLaps, {}, 2);
    EXPECT_LT(error_of(drive, estimated(drive, false)), 0.15);
}

TEST(TrajectoryEstimator, LaterLoopClosuresMoveFinalPosesOnly) {
    const Drive drive = drive_along(ring_building(), kTwoLaps, {.scale = 1.03, .turn = 0.004}, 3);
    LoneEstimator estimator;
    std::vector<Pose2> poses;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        estimator->add(scan_matching::points_of(drive.scans[n], drive.laser), drive.odometry[n]);
        poses.push_back(estimator->first_pose_of(n));
    }
    estimator.finish();
    double largest = 0.0;
    double largest_step_error = 0.0; // between scans taken in succession
    for (std::size_t n = 0; n < poses.size(); ++n) {
        ASSERT_EQ(estimator->first_pose_of(n), poses[n]);
        const Pose2 moved = compose(inverse(poses[n]), estimator->pose_of(n));
        largest = std::max(largest, std::hypot(moved.x, moved.y));
        if (n == 0) continue;
        const Pose2 step = compose(inverse(estimator->pose_of(n - 1)), estimator->pose_of(n));
        const Pose2 error = compose(inverse(compose(inverse(drive.truth[n - 1]), drive.truth[n])), step);
        largest_step_error = std::max(largest_step_error, std::hypot(error.x, error.y));
    }
    EXPECT_GT(largest, 0.05);
    EXPECT_LT(largest_step_error, 0.03) << "scans move with their keyframes";
    EXPECT_EQ(poses.front(), (Pose2{0.0, 0.0, 0.0})) << "the map begins at the first scan";
}

TEST(TrajectoryEstimator, FinishWithoutScansDoesNothing) {
    LoneEstimator estimator;
    estimator.finish();
    EXPECT_EQ(estimator->scan_count(), 0U);
}

/// A lidar that spins up, or is covered at first: what it sees then begins the map.
TEST(TrajectoryEstimator, StartsWithScansThatShowNothing) {
    const Building building = ring_building();
    for (const std::size_t beams : {0U, 5U}) {
        for (const bool has_odometry : {true, false}) {
            Drive drive = drive_along(building, std::vector<Point2>{{5.0, 1.0}, {9.0, 1.0}}, {}, 9);
            for (std::size_t n = 0; n < 3; ++n)
                std::fill(drive.scans[n].ranges.begin() + beams, drive.scans[n].ranges.end(), kNoReturn);
            const auto estimator = estimated(drive, has_odometry);
            EXPECT_LE(estimator->unmatched_count(), 3U) << beams;
            EXPECT_TRUE(estimator->is_located(drive.scans.size() - 1));
            EXPECT_LT(error_of(drive, estimator), 0.35) << beams << " beams at first, while it moves by 0.3 m";
        }
    }
}

TEST(TrajectoryEstimator, JumpsOfTheOdometryAreNotFollowed) {
    const Building building = ring_building();
    Drive drive = drive_along(building, std::vector<Point2>{{5.0, 1.0}, {13.0, 1.0}}, {}, 10);
    for (std::size_t n = 40; n < drive.odometry.size(); ++n) drive.odometry[n].x += 1e6;
    for (std::size_t n = 60; n < drive.odometry.size(); ++n) drive.odometry[n].y -= 1e6;
    EXPECT_LT(error_of(drive, estimated(drive, true)), 0.2);
}

TEST(TrajectoryEstimator, OdometryThatReversesWronglyIsNotFollowed) {
    const Building building = ring_building();
    Drive drive = drive_along(building, std::vector<Point2>{{22.0, 1.0}, {31.0, 1.0}}, {}, 4);
    std::mt19937 random(4);
    double speed = 0.1; // metres between scans: it slows down and backs up the way it came, without turning
    for (int n = 0; n < 80; ++n) {
        speed = std::max(-0.1, speed - 0.02);
        drive.truth.push_back(compose(drive.truth.back(), {speed, 0.0, 0.0}));
        drive.odometry.push_back(compose(drive.odometry.back(), {std::fabs(speed), 0.0, 0.0}));
        drive.scans.push_back(building.scan(drive.laser, drive.truth.back(), 0.01, random));
    }
    EXPECT_LT(error_of(drive, estimated(drive, true)), 0.5) << "of 14 m";
}

/// A robot that drives backwards along a corridor sees more and more walls that its newest keyframes do not show. All
/// that they show it sees, too, as if it stood.
TEST(TrajectoryEstimator, FollowsARobotThatDrivesBackwards) {
    Sensor laser = Building::laser();
    laser.range_max = 5.0;
    const std::vector<Point2> forwards{{30.0, 1.0}, {33.0, 1.0}, {33.0, 10.0}, {33.0, 1.0}, {3.0, 1.0}};
    Drive drive = drive_along(ring_building(), forwards, {}, 3, laser);
    std::ranges::reverse(drive.truth);
    std::ranges::reverse(drive.odometry);
    std::ranges::reverse(drive.scans);
    EXPECT_LT(error_of(drive, estimated(drive, true)), 0.3);
    EXPECT_LT(error_of(drive, estimated(drive, false)), 0.3);
}

TEST(TrajectoryEstimator, AStandingRobotAddsNoKeyframes) {
    const Building building = ring_building();
    Drive drive = drive_along(building, std::vector<Point2>{{5.0, 1.0}, {9.0, 1.0}}, {}, 5);
    const auto keyframes = estimated(drive, true).map->graph().size();
    std::mt19937 random(5);
    for (int n = 0; n < 600; ++n) {
        drive.truth.push_back(drive.truth.back());
        drive.odometry.push_back(drive.odometry.back());
        drive.scans.push_back(building.scan(drive.laser, drive.truth.back(), 0.01, random));
    }
    const auto estimator = estimated(drive, true);
    EXPECT_LE(estimator.map->graph().size(), keyframes + 1);
    EXPECT_LT(error_of(drive, estimator), 0.05);
}

TEST(TrajectoryEstimator, ScansThatShowNothingAreNotMatched) {
    const Building building = ring_building();
    Drive drive = drive_along(building, std::vector<Point2>{{5.0, 1.0}, {13.0, 1.0}}, {}, 6);
    for (std::size_t n = 20; n < 30; ++n) { // somebody stands in front of two thirds of the beams
        for (std::size_t beam = 30; beam < 150; ++beam) drive.scans[n].ranges[beam] = 400;
    }
    for (std::size_t n = 50; n < 55; ++n) drive.scans[n].ranges.assign(181, kNoReturn);
    const auto estimator = estimated(drive, true);
    EXPECT_GE(estimator->unmatched_count(), 5U);
    EXPECT_LE(estimator->unmatched_count(), 15U);
    EXPECT_LT(error_of(drive, estimator), 0.1);
}

/// Two scans that fit better somewhere else, but not well, and the next one is where the robot was: it tilted.
TEST(TrajectoryEstimator, ATiltIsNoMotion) {
    const Building building = ring_building();
    for (const bool has_odometry : {true, false}) {
        Drive drive = drive_along(building, std::vector<Point2>{{5.0, 1.0}, {13.0, 1.0}}, {}, 11);
        std::mt19937 random(11);
        for (std::size_t n = 40; n < 42; ++n) {
            drive.scans[n] = building.scan(drive.laser, compose(drive.truth[n], {0.4, 0.0, 0.0}), 0.01, random);
            for (std::size_t beam = 0; beam < 181; beam += 5) drive.scans[n].ranges[beam] /= 2;
        }
        EXPECT_LT(error_of(drive, estimated(drive, has_odometry)), 0.2) << has_odometry;
    }
}

/// Odometry can lead anywhere if it starts again now and then. What is estimated must remain what maps can show.
TEST(TrajectoryEstimator, ARobotBeyondAllCoordinatesBeginsAgain) {
    SharedMap map;
    TrajectoryEstimator estimator(map);
    for (int n = 0; n < 30; ++n) estimator.add({}, Pose2{kEstimateMax - 95.0 + 10.0 * n, 0.0, 0.0});
    estimator.finish();
    EXPECT_NEAR(estimator.first_pose_of(9).x, kEstimateMax - 5.0, 1e-6);
    EXPECT_LT(estimator.first_pose_of(29).x, 250.0);
    EXPECT_TRUE(estimator.needs_place());
    EXPECT_EQ(map.graph().fragments().size(), 2U);
    EXPECT_TRUE(map.is_consistent() && estimator.is_consistent());
}

TEST(TrajectoryEstimator, BeginsAFragmentAfterTwentyUnmatchedScans) {
    Drive drive = drive_along(ring_building(), std::vector<Point2>{{5.0, 1.0}, {9.0, 1.0}}, {}, 7);
    const std::size_t carried = drive.scans.size();
    carry_to_other_floor(drive, 80, 7);
    for (const bool has_odometry : {true, false}) {
        SCOPED_TRACE(has_odometry);
        const auto estimator = estimated(drive, has_odometry);
        const auto fragments = estimator.map->graph().fragments();
        ASSERT_EQ(fragments.size(), 2U);
        std::size_t begin = 0;
        while (estimator->placement(begin).keyframe != fragments[1].keyframes.front()) ++begin;
        EXPECT_EQ(begin, carried + 19) << "the twentieth scan on the other floor";
        EXPECT_EQ(estimator->unmatched_count(), 20U) << "all later scans match it";
    }
}

/// Without odometry and without a hole in the scans, only what the laser sees shows that a robot was carried.
TEST(TrajectoryEstimator, ARobotThatIsCarriedThroughItsHallIsLost) {
    const std::vector<Point2> way{{1.0, 1.0}, {13.0, 1.5}, {13.0, 8.0}, {6.0, 7.5}};
    for (const std::ptrdiff_t scans : {20, 40, 80}) {
        Drive drive = drive_along(other_building(), way, {}, 7);
        drive.scans.erase(drive.scans.begin() + 60, drive.scans.begin() + 60 + scans);
        const auto estimator = estimated(drive, false);
        EXPECT_TRUE(estimator->is_located(59));
        EXPECT_FALSE(estimator->is_located(drive.scans.size() - 1)) << scans / 10 << " m";
    }
}

/// Beams that hit the walls far away graze them, and hit both walls at the same places of the robot's frame all along.
TEST(TrajectoryEstimator, FollowsTheOdometryBetweenBareWalls) {
    Building corridor;
    corridor.add_box(-100.0, 0.0, 200.0, 2.0);
    for (const double range_max : {5.0, 20.0}) {
        Sensor laser = Building::laser();
        laser.range_max = range_max;
        std::mt19937 random(9);
        LoneEstimator estimator;
        Pose2 pose{0.0, 1.0, 0.0};
        for (int n = 0; n < 200; ++n) {
            pose.x += std::min(0.1, 0.005 * n); // the robot accelerates
            estimator->add(scan_matching::points_of(corridor.scan(laser, pose, 0.01, random), laser), pose);
        }
        estimator.finish();
        EXPECT_NEAR(estimator->pose_of(199).x - estimator->pose_of(0).x, pose.x, 0.1) << range_max;
    }
}

/// Between two bare walls a laser does not see how far its robot moves. The uncertainty stays until a loop is closed.
TEST(TrajectoryEstimator, BareWallsMakeThePositionUncertain) {
    Building building; // a corridor of 40 m with boxes at its ends
    building.add_box(0.0, 0.0, 40.0, 2.0);
    for (const double x : {1.0, 3.0, 36.0, 38.0}) building.add_box(x, 0.0, x + 0.4, 0.5);
    Sensor laser = Building::laser();
    laser.range_max = 5.0;
    const Drive drive = drive_along(building, std::vector<Point2>{{4.5, 1.0}, {35.0, 1.0}}, {}, 3, laser);
    std::map<bool, std::vector<double>> sigmas; // by whether there is odometry
    for (const bool has_odometry : {false, true}) {
        LoneEstimator estimator;
        for (std::size_t n = 0; n < drive.scans.size(); ++n) {
            estimator->add(scan_matching::points_of(drive.scans[n], laser),
                           has_odometry ? std::optional(drive.odometry[n]) : std::nullopt);
            sigmas[has_odometry].push_back(estimator->newest().position_sigma);
        }
    }
    EXPECT_LT(sigmas[false][5], 0.2) << "at the start";
    EXPECT_GT(sigmas[false].back(), 0.5);
    EXPECT_LT(sigmas[true].back(), 0.5 * sigmas[false].back());
    EXPECT_GT(sigmas[true].back(), 0.05);
}

/// The constant is the same for every compiler, processor and instruction set.
TEST(TrajectoryEstimator, PosesHaveTheSameBitsEverywhere) {
    // Without the C library's sine: positions are given, and yaws only turn by fixed steps.
    const Building building = ring_building();
    const Sensor laser = Building::laser();
    std::mt19937 random(8);
    LoneEstimator estimator;
    Pose2 pose{5.0, 1.0, 0.0};
    for (int n = 0; n < 120; ++n) {
        estimator->add(scan_matching::points_of(building.scan(laser, pose, 0.01, random), laser),
                       Pose2{1.02 * (pose.x - 5.0), pose.y - 1.0, 1.1 * pose.yaw});
        pose.x += 0.0625;
        pose.yaw = n % 32 < 16 ? pose.yaw + 0.015625 : pose.yaw - 0.015625;
    }
    estimator.finish();
    std::uint64_t hash = 0;
    for (std::size_t n = 0; n < estimator->scan_count(); ++n) {
        const Pose2 found = estimator->pose_of(n);
        for (const double value : {found.x, found.y, found.yaw}) {
            hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100'0000'01B3U;
        }
    }
    EXPECT_EQ(hash, 6315965965967721399U);
}

} // namespace
} // namespace scanloom::slam

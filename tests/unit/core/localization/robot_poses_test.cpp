#include "core/localization/robot_poses.hpp"
#include "tests/support/room_scans.hpp"
#include "tests/unit/core/slam/other_buildings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <random>
#include <vector>

namespace scanloom::localization {
namespace {

using slam::Drive;
using slam::drive_along;
using slam::ring_building;
using State = LocalizationState;
using testing_support::Building;

/// The poses of a robot that is alone in its map.
struct LonePoses {
    std::unique_ptr<slam::SharedMap> map = std::make_unique<slam::SharedMap>();
    RobotPoses poses{*map, 0};

    RobotPoses* operator->() noexcept { return &poses; }
    bool correct_if_due() {
        const bool is_due = poses.note_moves();
        if (is_due) poses.correct();
        return is_due;
    }
};

double distance(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x - b.x, a.y - b.y) + std::fabs(normalize_angle(a.yaw - b.yaw));
}

/// A lap of a corridor and a quarter, with odometry that drifts by metres.
const Drive& lap() {
    static const Drive drive = drive_along(ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    return drive;
}

/// Adds the scans of a drive with its odometry.
void add(LonePoses& poses, const Drive& drive) {
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.odometry = drive.odometry[n];
        poses->add(scan, drive.laser);
        static_cast<void>(poses.correct_if_due());
    }
}

TEST(RobotPoses, PosesInMapsFollowTheEstimatesWithinTheJump) {
    const Drive& drive = lap();
    LonePoses poses;
    double largest = 0.0;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.odometry = drive.odometry[n];
        const auto before = poses->in_maps();
        const auto added = poses->add(scan, drive.laser);
        ASSERT_TRUE(added);
        ASSERT_EQ(*added, poses->first(n)) << "maps show the first estimate";
        const bool is_corrected = poses.correct_if_due();
        const auto after = poses->in_maps();
        ASSERT_EQ(after.size(), n + 1);
        for (std::size_t earlier = 0; earlier < n; ++earlier) {
            const double off = distance(*after[earlier], poses->newest(earlier));
            ASSERT_TRUE(is_corrected || before[earlier] == after[earlier]) << "a pose moved without a correction";
            ASSERT_TRUE(!is_corrected || off <= kSettled);
            largest = std::max(largest, off);
        }
    }
    EXPECT_GT(poses->localization().corrections, 0U);
    EXPECT_LE(largest, 2.0 * RobotPoses::kJump) << "a keyframe beyond kJump is corrected; scans turn about keyframes";
}

TEST(RobotPoses, SmallImprovementsWaitUntilTheLogHasGrown) {
    EXPECT_TRUE(is_worth_a_correction(0.11, 2000, 0)) << "a jump does not wait";
    EXPECT_FALSE(is_worth_a_correction(0.09, 2000, 199));
    EXPECT_TRUE(is_worth_a_correction(0.09, 2000, 200)) << "a tenth more keyframes";
    EXPECT_FALSE(is_worth_a_correction(0.09, 100, 49));
    EXPECT_TRUE(is_worth_a_correction(0.09, 100, 50));
    EXPECT_FALSE(is_worth_a_correction(0.04, 2000, 2000)) << "less than a cell";
}

TEST(RobotPoses, WhatMovedLittleStays) {
    const Drive& drive = lap();
    LonePoses poses;
    std::size_t kept = 0;
    std::size_t moved = 0;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.odometry = drive.odometry[n];
        poses->add(scan, drive.laser);
        const auto before = poses->in_maps();
        if (!poses.correct_if_due()) continue;
        const auto after = poses->in_maps();
        for (std::size_t earlier = 0; earlier <= n; ++earlier) {
            const bool is_close = distance(*before[earlier], poses->newest(earlier)) <= kSettled;
            EXPECT_EQ(is_close, before[earlier] == after[earlier]);
            ++(is_close ? kept : moved);
        }
    }
    EXPECT_GT(kept, 0U);
    EXPECT_GT(moved, 0U);
}

TEST(RobotPoses, TheMapBeginsAtTheOdometryOfTheFirstScan) {
    Drive drive = drive_along(ring_building(), std::vector<Point2>{{5.0, 1.0}, {9.0, 1.0}}, {}, 3);
    const Pose2 start{100.0, -20.0, 2.0};
    for (Pose2& odometry : drive.odometry) odometry = compose(start, odometry);
    LonePoses poses;
    add(poses, drive);
    EXPECT_NEAR(distance(poses->newest(0), start), 0.0, 1e-12);
    EXPECT_LT(distance(poses->location().T_map_odom, {}), 0.15) << "0.001 rad turn a place 100 m away by 0.1 m";
    EXPECT_EQ(poses->localization().state, State::kTracking);
    EXPECT_GT(poses->localization().inlier_ratio, 0.9);
    EXPECT_GT(poses->localization().position_sigma, 0.0);
    EXPECT_LT(poses->localization().position_sigma, 0.05);
}

TEST(RobotPoses, SonarScansFollowTheLaserScans) {
    const Drive& drive = lap();
    Sensor sonar;
    sonar.id = 1;
    sonar.kind = SensorKind::kSonar;
    LonePoses poses;
    Scan echo;
    echo.odometry = Pose2{-0.5, 0.0, 0.0};
    EXPECT_EQ(*poses->add(echo, sonar), *echo.odometry) << "before the first laser scan, the odometry counts";
    EXPECT_EQ(poses->localization().state, State::kUnlocated);
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.odometry = drive.odometry[n];
        poses->add(scan, drive.laser);
        static_cast<void>(poses.correct_if_due());
        echo.odometry = compose(drive.odometry[n], {0.05, 0.01, 0.02});
        poses->add(echo, sonar);
        static_cast<void>(poses.correct_if_due());
    }
    ASSERT_GT(poses->localization().corrections, 0U);
    for (std::size_t n = 1; n < poses->scan_count(); n += 2) {
        const Pose2 expected = compose(poses->newest(n), {0.05, 0.01, 0.02});
        ASSERT_LT(distance(poses->newest(n + 1), expected), 1e-9);
        ASSERT_LT(distance(*poses->in_maps()[n + 1], compose(*poses->in_maps()[n], {0.05, 0.01, 0.02})),
                  3.0 * kSettled);
    }
}

/// A laser that sees 5 m of a room of 10 m: each scan shows much that the scans before did not.
TEST(RobotPoses, ALaserOfShortRangeIsTracked) {
    constexpr int kScans = 240; // of a round
    const Sensor laser = testing_support::reference_laser();
    const auto round = testing_support::room_scans(kScans);
    LonePoses poses;
    Pose2 odometry;
    double largest = 0.0;
    for (std::size_t n = 0; n < 2 * kScans; ++n) {
        Scan scan = round[n % kScans];
        const Pose2 truth = compose(inverse(*round[0].pose), *scan.pose);
        if (n > 0) {
            const Pose2 step = compose(inverse(*round[(n - 1) % kScans].pose), *scan.pose);
            odometry = compose(odometry, {1.03 * step.x, 1.03 * step.y, 1.04 * step.yaw});
        }
        scan.odometry = odometry;
        ASSERT_TRUE(poses->add(scan, laser)) << n;
        static_cast<void>(poses.correct_if_due());
        largest = std::max(largest, distance(poses->newest(n), truth));
    }
    EXPECT_LT(largest, 0.06);
}

/// A robot is carried to another floor: maps do not show the scans of the other floor.
TEST(RobotPoses, ScansOfAnUnknownPlaceAreNotInMaps) {
    Drive drive = drive_along(ring_building(), std::vector<Point2>{{5.0, 1.0}, {12.0, 1.0}}, {}, 5);
    const std::size_t carried = drive.scans.size();
    slam::carry_to_other_floor(drive, 80, 5);
    LonePoses poses;
    add(poses, drive);
    EXPECT_EQ(poses->localization().state, State::kLost);
    std::size_t shown = 0;
    for (std::size_t n = carried; n < poses->scan_count(); ++n) shown += poses->in_maps()[n] ? 1 : 0;
    EXPECT_LE(shown, 2U) << "the first turn may look like the corridor";
    for (std::size_t n = 0; n < carried; ++n) ASSERT_TRUE(poses->in_maps()[n]);
    EXPECT_FALSE(poses->is_fragment_located(poses->scan_count() - 1));
}

/// A robot sees nothing for two seconds, and goes on: what it maps then is shown when it comes back to a known place.
TEST(RobotPoses, APartThatIsConnectedLaterIsShownThen) {
    const std::vector<Point2> there_and_back{{5.0, 1.0}, {25.0, 1.0}, {6.0, 1.0}};
    Drive drive = drive_along(ring_building(), there_and_back, {.scale = 1.01}, 6);
    for (std::size_t n = 80; n < 110; ++n) drive.scans[n].ranges.assign(drive.scans[n].ranges.size(), kNoReturn);
    LonePoses poses;
    add(poses, drive);
    EXPECT_EQ(poses->localization().state, State::kTracking);
    std::size_t shown = 0;
    for (std::size_t n = 0; n < poses->scan_count(); ++n) shown += poses->in_maps()[n] ? 1 : 0;
    EXPECT_GT(shown, poses->scan_count() - 60);
    EXPECT_LT(slam::largest_error(drive, [&](std::size_t n) { return poses->newest(n); }), 0.4);
}

} // namespace
} // namespace scanloom::localization

#include "robot_client/sources/carmen_log.hpp"

#include "tests/unit/robot_client/sources/carmen_log_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

class CarmenLogPoses : public CarmenLogFile {};

CarmenOptions with_poses(Poses poses) {
    CarmenOptions options;
    options.poses = poses;
    return options;
}

std::string flaser_at(const Pose2& laser, const Pose2& robot, double stamp) {
    return fmt::format("FLASER 1 1.0 {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {} host 1\n", laser.x, laser.y,
                       laser.yaw, robot.x, robot.y, robot.yaw, stamp);
}

/// Returns three FLASER lines along a curve, with the laser at `mount`; the last one's differs by `shift`.
std::string flasers_with_mount(const Pose2& mount, const Pose2& shift) {
    std::string text;
    for (int i = 0; i < 3; ++i) {
        const Pose2 robot{0.5 * i, 0.1 * i, 3.0 + 0.2 * i};
        const Pose2 here = i < 2 ? mount : Pose2{mount.x + shift.x, mount.y + shift.y, mount.yaw + shift.yaw};
        text += flaser_at(compose(robot, here), Pose2{robot.x, robot.y, normalize_angle(robot.yaw)}, i);
    }
    return text;
}

TEST_F(CarmenLogPoses, FlaserOdometryIsTheSecondTripleAndAConstantOffsetIsTheMount) {
    const Pose2 mount{0.15, -0.02, 0.1};
    const std::string text = flasers_with_mount(mount, {0.0009, -0.0009, 0.0009});
    for (const Poses poses : {Poses::kOdometry, Poses::kNone}) {
        const auto log = read(text, with_poses(poses));
        ASSERT_TRUE(log);
        ASSERT_EQ(log->observations.size(), 3U);
        for (const auto& [sensor, scan] : log->observations) {
            EXPECT_NEAR(sensor->mount.x, mount.x, 1e-5);
            EXPECT_NEAR(sensor->mount.y, mount.y, 1e-5);
            EXPECT_NEAR(sensor->mount.yaw, mount.yaw, 1e-5);
            EXPECT_EQ(sensor, log->observations[0].sensor);
        }
        const Scan& second = log->observations[1].scan;
        if (poses == Poses::kOdometry) {
            EXPECT_EQ(second.odometry, (Pose2{0.5, 0.1, -3.083185}));
        } else {
            EXPECT_FALSE(second.odometry);
        }
        EXPECT_FALSE(second.pose);
    }
    EXPECT_EQ(read(text)->observations[2].sensor->mount, Pose2{}) << "poses in the map";
}

TEST_F(CarmenLogPoses, FlaserMountIsTheIdentityIfTheOffsetVaries) {
    const Pose2 mount{0.15, -0.02, 0.1};
    for (const Pose2& shift : {Pose2{0.0011, 0, 0}, Pose2{0, -0.0011, 0}, Pose2{0, 0, 0.0011}}) {
        for (const Poses poses : {Poses::kOdometry, Poses::kNone}) {
            const auto log = read(flasers_with_mount(mount, shift), with_poses(poses));
            ASSERT_TRUE(log);
            for (const auto& [sensor, scan] : log->observations) EXPECT_EQ(sensor->mount, Pose2{});
        }
    }
}

TEST_F(CarmenLogPoses, FlaserMountIsTheIdentityIfTheLaserIsTooFarFromTheRobot) {
    const auto log = read("FLASER 1 1.0 900000 0 0 -900000 0 0 1 host 1\n", with_poses(Poses::kOdometry));
    ASSERT_TRUE(log);
    EXPECT_EQ(log->observations[0].sensor->mount, Pose2{});
    EXPECT_EQ(log->observations[0].scan.odometry, (Pose2{-900000, 0, 0}));
}

TEST_F(CarmenLogPoses, RobotLaserOdometryIsTheRobotPose) {
    const std::string text = robot_laser("1.25 2.5 0.3", "1.0 2.4 0.31");
    const auto log = read(text, with_poses(Poses::kOdometry));
    ASSERT_TRUE(log);
    EXPECT_EQ(log->observations[0].scan.odometry, (Pose2{1.0, 2.4, 0.31}));
    EXPECT_FALSE(log->observations[0].scan.pose);
    EXPECT_EQ(log->observations[0].sensor->mount, read(text)->observations[0].sensor->mount);

    const auto none = read(text, with_poses(Poses::kNone));
    ASSERT_TRUE(none);
    EXPECT_FALSE(none->observations[0].scan.odometry);
    EXPECT_FALSE(none->observations[0].scan.pose);
    EXPECT_EQ(none->observations[0].sensor->mount, log->observations[0].sensor->mount);
    EXPECT_FALSE(read(text)->observations[0].scan.odometry) << "poses in the map";
}

TEST_F(CarmenLogPoses, RawLaserOdometryIsInterpolated) {
    const auto log = read(text_of({"PARAM robot_frontlaser_offset 0.1 1 h 1\nODOM 2 4 0.5 0 0 0 10.25 h 1\n", kRawLaser,
                                   "ODOM 4 8 0.7 0 0 0 10.75 h 1\n"}),
                          with_poses(Poses::kOdometry));
    ASSERT_TRUE(log);
    const auto& [sensor, scan] = log->observations[0];
    ASSERT_TRUE(scan.odometry);
    EXPECT_NEAR(scan.odometry->x, 3.0, 1e-12);
    EXPECT_NEAR(scan.odometry->y, 6.0, 1e-12);
    EXPECT_NEAR(scan.odometry->yaw, 0.6, 1e-12);
    EXPECT_FALSE(scan.pose);
    EXPECT_EQ(sensor->mount, (Pose2{0.1, 0, 0}));
}

TEST_F(CarmenLogPoses, RawLaserWithoutPosesNeedsNoOdometry) {
    const auto log = read(text_of({"PARAM robot_frontlaser_offset 0.1 1 h 1\n", kRawLaser}), with_poses(Poses::kNone));
    ASSERT_TRUE(log);
    EXPECT_TRUE(skipped_.empty());
    EXPECT_FALSE(log->observations[0].scan.odometry || log->observations[0].scan.pose);
    EXPECT_EQ(log->observations[0].sensor->mount, (Pose2{0.1, 0, 0}));
    EXPECT_FALSE(read(kRawLaser, with_poses(Poses::kOdometry)));
}

TEST_F(CarmenLogPoses, OrderOfScansDoesNotDependOnPoses) {
    const std::string text = text_of({flaser(30, "1 0.3"), flaser(10, "1 0.1"), flaser(9, "1 0.2")});
    for (const Poses poses : {Poses::kOdometry, Poses::kNone}) {
        EXPECT_EQ(first_ranges(*read(text, with_poses(poses))), first_ranges(*read(text)));
    }
}

TEST_F(CarmenLogPoses, FingerprintDependsOnPoses) {
    const std::string map = read(flaser(1), with_poses(Poses::kMap))->fingerprint;
    const std::string odometry = read(flaser(1), with_poses(Poses::kOdometry))->fingerprint;
    const std::string none = read(flaser(1), with_poses(Poses::kNone))->fingerprint;
    EXPECT_EQ(map, read(flaser(1))->fingerprint);
    EXPECT_NE(odometry, map);
    EXPECT_NE(none, map);
    EXPECT_NE(none, odometry);
}

} // namespace
} // namespace scanloom::robot

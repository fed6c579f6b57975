#include "core/localization/mount_check.hpp"
#include "core/localization/session_poses.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

namespace scanloom::localization {
namespace {

/// Returns what is reported of a robot whose mount is described with a yaw that is wrong.
std::optional<double> reported(double yaw_error, const slam::OdometryErrors& errors) {
    const slam::Drive drive = slam::drive_along(slam::ring_building(),
                                                std::vector<Point2>{{10.0, 1.0}, {33.0, 1.0}, {33.0, 12.0}}, errors, 1);
    Sensor described = drive.laser;
    described.mount.yaw += yaw_error;
    SessionPoses poses;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        ScanTaken taken{0, drive.scans[n]};
        taken.scan.pose.reset();
        taken.scan.odometry = drive.odometry[n];
        poses.estimate(taken, described, n + 1);
    }
    return poses.find(0)->localization().mount_yaw_error;
}

TEST(MountCheck, ReportsALaserThatLooksInAnotherDirection) {
    for (const double error : {std::numbers::pi, std::numbers::pi / 2.0, -std::numbers::pi / 2.0, 0.5, -0.5}) {
        const auto found = reported(error, {.scale = 1.03, .turn = 0.01});
        ASSERT_TRUE(found) << error;
        EXPECT_LT(std::fabs(std::remainder(*found - error, 2.0 * std::numbers::pi)), 0.1) << error;
    }
}

TEST(MountCheck, DoesNotReportDriftingOdometry) {
    for (const double turn : {-0.05, 0.0, 0.05}) {
        for (const double scale : {0.8, 1.2}) {
            EXPECT_FALSE(reported(0.0, {.scale = scale, .turn = turn})) << turn << ", " << scale;
        }
    }
}

TEST(MountCheck, WaitsForSomeMetresAndForgetsThem) {
    const auto moved = [](double x, double y) { return scan_matching::transform_of({x, y, 0.0}); };
    MountCheck check;
    for (int n = 0; n < 40; ++n) check.add(moved(0.1, 0.0), moved(-0.1, 0.0));
    EXPECT_FALSE(check.yaw_error()) << "4 m";
    for (int n = 0; n < 60; ++n) check.add(moved(0.1, 0.0), moved(-0.1, 0.0));
    EXPECT_TRUE(check.yaw_error()) << "10 m";
    for (int n = 0; n < 300; ++n) check.add(moved(0.1, 0.0), moved(0.1, 0.0)); // the mount was described again
    EXPECT_FALSE(check.yaw_error());
}

TEST(MountCheck, IgnoresMotionsWithoutDirection) {
    MountCheck check;
    const auto still = scan_matching::transform_of({0.001, 0.0, 0.0});
    const auto turn = scan_matching::transform_of({0.1, 0.0, 0.5});
    const auto jump = scan_matching::transform_of({-3.0, 0.0, 0.0});
    for (int n = 0; n < 1000; ++n) {
        check.add(still, inverse(still));
        check.add(turn, inverse(turn));
        check.add(scan_matching::transform_of({0.1, 0.0, 0.0}), jump);
    }
    EXPECT_FALSE(check.yaw_error());
}

} // namespace
} // namespace scanloom::localization

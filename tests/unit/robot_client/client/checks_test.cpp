#include "robot_client/client/checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanloom::robot {
namespace {

using testing::HasSubstr;

Scan scan_with(bool pose, bool odometry) {
    Scan scan;
    if (pose) scan.pose = Pose2{};
    if (odometry) scan.odometry = Pose2{};
    return scan;
}

std::string refusal(Poses poses, const Scan& scan) {
    const auto checked = check_poses(scan, poses);
    if (checked) return "accepted";
    EXPECT_EQ(checked.error().code, Errc::kInvalidField);
    return checked.error().message;
}

TEST(ClientChecks, AcceptScansWithThePosesOfTheClient) {
    EXPECT_EQ(refusal(Poses::kMap, scan_with(true, false)), "accepted");
    EXPECT_EQ(refusal(Poses::kMap, scan_with(true, true)), "accepted") << "the odometry is optional";
    EXPECT_EQ(refusal(Poses::kOdometry, scan_with(false, true)), "accepted");
    EXPECT_EQ(refusal(Poses::kNone, scan_with(false, false)), "accepted");
}

TEST(ClientChecks, RefuseScansWithOtherPoses) {
    EXPECT_THAT(refusal(Poses::kMap, scan_with(false, true)), HasSubstr("the scan has no pose; set it"));
    EXPECT_THAT(refusal(Poses::kOdometry, scan_with(true, true)),
                HasSubstr("has a pose, but the client was started with poses odometry; leave the pose out"));
    EXPECT_THAT(refusal(Poses::kOdometry, scan_with(false, false)), HasSubstr("the scan has no odometry"));
    EXPECT_THAT(refusal(Poses::kNone, scan_with(true, false)),
                HasSubstr("started with poses none; leave the pose out"));
    EXPECT_THAT(refusal(Poses::kNone, scan_with(false, true)), HasSubstr("the scan has an odometry"));
}

} // namespace
} // namespace scanloom::robot

#include "robot_client/sources/pose_check.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace scanloom::robot {
namespace {

/// The scans of a drive, with the given poses.
class DrivenScans final : public Source {
public:
    DrivenScans(const slam::Drive& drive, const std::vector<Pose2>& poses) : drive_(drive), poses_(poses) {}

    [[nodiscard]] Result<std::optional<Observation>> next() override {
        if (next_ == poses_.size()) return std::optional<Observation>();
        Scan scan = drive_.scans[next_];
        scan.pose = poses_[next_++];
        return std::optional(Observation{std::make_shared<const Sensor>(drive_.laser), std::move(scan)});
    }
    [[nodiscard]] std::optional<std::uint64_t> scan_count() const override { return poses_.size(); }
    [[nodiscard]] std::string remarks() const override { return "two lines are damaged"; }

private:
    const slam::Drive& drive_;
    const std::vector<Pose2>& poses_;
    std::size_t next_ = 0;
};

std::string remarks_after(const slam::Drive& drive, const std::vector<Pose2>& poses) {
    CheckedPoses source(std::make_unique<DrivenScans>(drive, poses));
    while (source.next().value()) {
    }
    return source.remarks();
}

TEST(PoseCheck, RemarksOnPosesThatScansContradict) {
    const slam::Drive drive =
        slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    EXPECT_EQ(remarks_after(drive, drive.truth), "two lines are damaged");
    EXPECT_EQ(remarks_after(drive, drive.odometry),
              "two lines are damaged; scans contradict their poses, and these poses look like odometry: "
              "--poses odometry");
}

TEST(PoseCheck, DecidesOnlyWhereScansSeePlacesAgain) {
    const slam::Drive drive = slam::drive_along(slam::ring_building(), std::vector<Point2>{{5.0, 1.0}, {14.0, 1.0}},
                                                {.scale = 1.5, .turn = 0.05}, 1);
    PoseCheck check;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.pose = drive.odometry[n];
        check.add(scan, drive.laser);
    }
    EXPECT_EQ(check.contradicted_share(), 0.0);
    EXPECT_FALSE(check.looks_like_odometry());
}

TEST(PoseCheck, IgnoresScansWithoutAPoseAndOfSonars) {
    slam::Drive drive =
        slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
    PoseCheck check;
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.pose.reset();
        check.add(scan, drive.laser);
        Sensor sonar = drive.laser;
        sonar.kind = SensorKind::kSonar;
        scan.pose = drive.odometry[n];
        check.add(scan, sonar);
    }
    EXPECT_EQ(check.contradicted_share(), 0.0);
}

} // namespace
} // namespace scanloom::robot

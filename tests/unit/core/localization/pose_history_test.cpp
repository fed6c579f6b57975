#include "core/localization/session_poses.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace scanloom::localization {
namespace {

using slam::Drive;

/// The poses of the first scans of robots.
using Poses = std::vector<std::vector<std::optional<Pose2>>>;

Poses poses_in(const mapping::ScanPoses& scans, const std::vector<std::size_t>& counts) {
    Poses poses;
    for (RobotIndex robot = 0; robot < counts.size(); ++robot) {
        auto& of_robot = poses.emplace_back();
        for (std::size_t seq = 1; seq <= counts[robot]; ++seq) of_robot.push_back(scans.find(robot, seq));
    }
    return poses;
}

/// Two robots whose scans alternate, after the first one has made a lap.
class PoseHistoryTest : public testing::Test {
protected:
    PoseHistoryTest() {
        const Drive lap =
            slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1);
        const Drive other = slam::drive_along(
            slam::ring_building(), std::vector<Point2>{{24.0, 21.0}, {1.0, 21.0}, {1.0, 8.0}}, {.scale = 0.98}, 2);
        const std::size_t before = lap.scans.size() - other.scans.size();
        for (std::size_t n = 0; n < lap.scans.size(); ++n) {
            add(0, lap, n);
            if (n >= before) add(1, other, n - before);
        }
    }

    void add(RobotIndex robot, const Drive& drive, std::size_t n) {
        ScanTaken taken{robot, drive.scans[n]};
        taken.scan.pose.reset();
        taken.scan.odometry = drive.odometry[n];
        taken.scan.stamp = static_cast<double>(++revision_);
        poses_.estimate(taken, drive.laser, revision_);
        counts_[robot] = n + 1;
        const bool is_corrected = poses_.corrected() == revision_;
        corrections_ += is_corrected ? 1 : 0;
        if (is_corrected || was_corrected_ || revision_ % 100 == 0) {
            shown_[revision_] = poses_in(poses_.in_maps(), counts_);
            counts_then_[revision_] = counts_;
        }
        was_corrected_ = is_corrected;
    }

    SessionPoses poses_;
    Revision revision_ = 0;
    std::vector<std::size_t> counts_ = std::vector<std::size_t>(2);
    std::map<Revision, Poses> shown_;
    std::map<Revision, std::vector<std::size_t>> counts_then_;
    std::size_t corrections_ = 0;
    bool was_corrected_ = false;
};

TEST_F(PoseHistoryTest, PosesAreThoseThatMapsShowedThen) {
    ASSERT_GT(corrections_, 1U);
    const PoseHistory history = poses_.history();
    for (const auto& [revision, expected] : shown_) {
        const auto then = history.at(revision);
        EXPECT_EQ(poses_in(then, counts_then_[revision]), expected) << "at entry " << revision;
        EXPECT_LE(then.corrected(), revision);
        const auto before = history.before(static_cast<double>(revision) + 0.5, Exclusions());
        EXPECT_EQ(poses_in(before, counts_then_[revision]), expected) << "before the scan after entry " << revision;
        EXPECT_EQ(before.corrected(), then.corrected());
    }
    EXPECT_EQ(history.at(revision_).corrected(), poses_.corrected());
    Exclusions all;
    for (const RobotIndex robot : {0U, 1U}) {
        ASSERT_TRUE(all.add(revision_ + robot + 1, ScansExcluded{robot + 1, robot, StampRange{10.0, 1e9}}));
    }
    EXPECT_EQ(history.before(10.0, all).corrected(), poses_.corrected()) << "excluded scans are not later ones";
    EXPECT_EQ(history.at(0).corrected(), 0U);
    std::size_t moved = 0;
    for (const auto& [revision, then] : shown_) {
        moved += then == poses_in(history.at(revision_), counts_then_[revision]) ? 0 : 1;
    }
    EXPECT_GT(moved, 1U) << "moments whose poses were corrected since";
}

} // namespace
} // namespace scanloom::localization

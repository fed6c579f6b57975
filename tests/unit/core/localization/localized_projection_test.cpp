#include "core/localization/localized_projection.hpp"
#include "core/scan_matching/deskew.hpp"
#include "tests/support/digests.hpp"
#include "tests/unit/core/localization/two_robots_log.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <variant>
#include <vector>

namespace scanloom::localization {
namespace {

using slam::Drive;
using testing_support::digests_of;

std::vector<LogEntry> log_of(const Drive& drive) {
    std::vector<LogEntry> log{RobotJoined{0, "robot", {}, {}, Poses::kOdometry}, SensorDescribed{0, drive.laser}};
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.seq = n + 1;
        scan.pose.reset();
        scan.odometry = drive.odometry[n];
        log.push_back(ScanTaken{0, scan});
    }
    return log;
}

void apply(LocalizedProjection& maps, LogEntry entry) {
    double work = HUGE_VAL;
    ASSERT_TRUE(maps.apply(entry, work).value());
}

/// The maps of the log with the poses that maps show.
mapping::Projection made_again(const std::vector<LogEntry>& log, const mapping::ScanPoses& poses) {
    mapping::Projection maps{mapping::MapConfig()};
    for (LogEntry entry : log) {
        poses.place(entry);
        EXPECT_TRUE(maps.apply(entry));
    }
    return maps;
}

TEST(LocalizedProjection, ReplacedMapsAreThoseOfTheCorrectedPoses) {
    const auto log =
        log_of(slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.03, .turn = 0.004}, 1));
    LocalizedProjection maps(mapping::Projection{mapping::MapConfig()});
    std::size_t replaced = 0;
    for (std::size_t n = 0; n < log.size(); ++n) {
        apply(maps, log[n]);
        ASSERT_EQ(maps.is_outdated(), maps.moving_scans() > 0);
        if (!maps.is_outdated()) continue;
        const std::vector<LogEntry> so_far(log.begin(), log.begin() + static_cast<std::ptrdiff_t>(n + 1));
        maps.replace(made_again(so_far, maps.poses().in_maps()), maps.poses().corrected());
        EXPECT_FALSE(maps.is_outdated());
        ++replaced;
    }
    ASSERT_GT(replaced, 0U);
    auto expected = made_again(log, maps.poses().in_maps());
    EXPECT_EQ(digests_of(maps.projection().snapshot()), digests_of(expected.snapshot()));
    EXPECT_EQ(maps.projection().snapshot().robots[0].scan_count, log.size() - 2);
}

/// Returns the log with scans ten times a second whose beams were taken during half of the time.
std::vector<LogEntry> with_times(std::vector<LogEntry> log) {
    for (LogEntry& entry : log) {
        auto* taken = std::get_if<ScanTaken>(&entry);
        if (taken == nullptr) continue;
        taken->scan.stamp = 0.1 * static_cast<double>(taken->scan.seq);
        taken->scan.duration = 0.05;
    }
    return log;
}

TEST(LocalizedProjection, MapsShowScansDeskewedByTheMotionSinceTheScanBefore) {
    const std::vector<Point2> way{{10.0, 1.0}, {14.0, 1.0}};
    const Drive drive = slam::drive_along(slam::ring_building(), way, {}, 3);
    for (const Poses poses : {Poses::kOdometry, Poses::kMap}) {
        std::vector<LogEntry> skewed = with_times(log_of(drive));
        std::get<RobotJoined>(skewed[0]).poses = poses;
        for (std::size_t n = 0; n < drive.scans.size(); ++n) {
            std::get<ScanTaken>(skewed[n + 2]).scan.pose = drive.truth[n]; // as ScanPoses::place()
        }
        std::vector<LogEntry> still = skewed;
        for (std::size_t n = 0; n < drive.scans.size(); ++n) {
            Scan& scan = std::get<ScanTaken>(still[n + 2]).scan;
            if (n > 0 && poses != Poses::kMap) {
                const Pose2 motion = compose(inverse(drive.truth[n - 1]), drive.truth[n]);
                const double seconds = scan.stamp - std::get<ScanTaken>(still[n + 1]).scan.stamp;
                scan = scan_matching::deskewed(scan, drive.laser, {motion, seconds});
            }
            scan.duration = 0.0;
        }
        EXPECT_EQ(digests_of(made_again(skewed, {}).snapshot()), digests_of(made_again(still, {}).snapshot()))
            << name_of(poses);
        EXPECT_NE(std::get<ScanTaken>(still[9]).scan.ranges == drive.scans[7].ranges, poses != Poses::kMap);
    }
}

TEST(LocalizedProjection, EqualLogsGiveEqualPosesInPartsAndWhole) {
    const auto log =
        with_times(log_of(slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.02}, 2)));
    LocalizedProjection whole(mapping::Projection{mapping::MapConfig()});
    LocalizedProjection parts(mapping::Projection{mapping::MapConfig()});
    for (const auto& entry : log) {
        apply(whole, entry);
        LogEntry repeated = entry;
        for (bool is_applied = false; !is_applied;) {
            double work = 1e4; // a part of a scan
            is_applied = parts.apply(repeated, work).value();
        }
        ASSERT_EQ(whole.poses().corrected(), parts.poses().corrected());
    }
    EXPECT_EQ(whole.poses().trajectory(0, Estimate::kNewest), parts.poses().trajectory(0, Estimate::kNewest));
    EXPECT_EQ(digests_of(whole.projection().snapshot()), digests_of(parts.projection().snapshot()));
}

TEST(LocalizedProjection, ARobotIsLocatedInTheMapThatAnotherOneMakesWithItsPoses) {
    const Drive sender = slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {}, 4);
    const std::vector<Point2> way{{20.0, 21.0}, {1.0, 21.0}, {1.0, 1.0}, {30.0, 1.0}};
    const Drive follower = slam::drive_along(slam::ring_building(), way, {.scale = 1.02, .turn = 0.003}, 5);
    const std::size_t half = sender.scans.size() / 2; // the rest of the map is unknown when the other one starts
    LocalizedProjection maps(mapping::Projection{mapping::MapConfig()});
    for (const LogEntry& entry : log_of_two(sender, follower, half)) apply(maps, entry);
    const auto* poses = maps.poses().find(1);
    ASSERT_NE(poses, nullptr);
    ASSERT_EQ(poses->localization().state, LocalizationState::kTracking);
    for (std::size_t n = 0; n < follower.scans.size(); ++n) {
        ASSERT_TRUE(poses->is_fragment_located(n)) << "also before it was located";
        const Pose2 pose = poses->newest(n);
        ASSERT_LT(std::hypot(pose.x - follower.truth[n].x, pose.y - follower.truth[n].y), 0.15) << n;
    }
    const auto graph = maps.poses().graph();
    const auto of_sender = std::ranges::count(graph.keyframes, RobotIndex{0}, &PoseGraphView::Node::robot);
    EXPECT_GT(of_sender, 40) << "of half the way";
    const auto is_true = [&](const PoseGraphView::Node& node) {
        return node.robot != 0 || std::ranges::any_of(sender.truth, [&](const Pose2& pose) {
                   return std::hypot(pose.x - node.pose.x, pose.y - node.pose.y) < 0.001;
               });
    };
    EXPECT_TRUE(std::ranges::all_of(graph.keyframes, is_true)) << "sent poses do not move";
}

/// What a robot with odometry sees before any map exists is kept until a robot that sends its poses shows the place.
TEST(LocalizedProjection, ARobotWaitsForTheMapOfAnotherOneWhosePosesGiveTheFrame) {
    const Drive sender = slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {}, 6);
    const std::vector<Point2> way{{3.0, 1.0}, {33.0, 1.0}, {33.0, 15.0}};
    const Drive follower = slam::drive_along(slam::ring_building(), way, {.scale = 1.02}, 7);
    std::vector<LogEntry> log = log_of_two(sender, follower, 1);
    Scan& first = std::get<ScanTaken>(log[4]).scan;
    first.ranges.assign(first.ranges.size(), kNoReturn);
    LocalizedProjection maps(mapping::Projection{mapping::MapConfig()});
    for (std::size_t n = 0; n < log.size(); ++n) {
        apply(maps, log[n]);
        if (n == 60) {
            EXPECT_EQ(maps.poses().find(1)->localization().state, LocalizationState::kUnlocated);
        }
    }
    const auto* poses = maps.poses().find(1);
    ASSERT_EQ(poses->localization().state, LocalizationState::kTracking);
    EXPECT_LT(std::hypot(poses->newest(0).x - way[0].x, poses->newest(0).y - way[0].y), 0.15);
}

TEST(LocalizedProjection, RemembersTheNewestAnnouncement) {
    LocalizedProjection maps(mapping::Projection{mapping::MapConfig()});
    apply(maps, RobotJoined{0, "robot", {}, {}, Poses::kOdometry});
    EXPECT_EQ(maps.announced(), 0U);
    apply(maps, MapsCorrected{1});
    EXPECT_EQ(maps.announced(), 1U);
}

} // namespace
} // namespace scanloom::localization

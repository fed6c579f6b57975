#include "core/localization/localized_projection.hpp"
#include "tests/support/digests.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
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

TEST(LocalizedProjection, EqualLogsGiveEqualPosesInPartsAndWhole) {
    const auto log = log_of(slam::drive_along(slam::ring_building(), slam::kLapAndAQuarter, {.scale = 1.02}, 2));
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

TEST(LocalizedProjection, RemembersTheNewestAnnouncement) {
    LocalizedProjection maps(mapping::Projection{mapping::MapConfig()});
    apply(maps, RobotJoined{0, "robot", {}, {}, Poses::kOdometry});
    EXPECT_EQ(maps.announced(), 0U);
    apply(maps, MapsCorrected{1});
    EXPECT_EQ(maps.announced(), 1U);
}

} // namespace
} // namespace scanloom::localization

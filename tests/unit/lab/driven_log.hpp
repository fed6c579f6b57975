#pragma once

#include "lab/recorded_log.hpp"

#include "tests/unit/core/slam/drive.hpp"

#include <fmt/format.h>

#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace scanloom::lab {

/// A log of a simulated drive, and where the robot really was.
struct DrivenLog {
    RecordedLog log;
    std::vector<Pose2> true_poses; ///< T_map_robot of each scan
};

inline constexpr std::size_t kBetweenRelated = 20; ///< scans between the two scans of a relation

inline const Pose2 kOdometryBegins{5.0, -3.0, std::numbers::pi / 2.0}; ///< of a drive that begins along the x axis

/// Drives two rounds through a room of 10 x 8 m with a pillar, two scans a second. Each motion of the odometry is 5 %
/// too long and turns by 2 degrees a metre. The relations are exact.
inline DrivenLog driven_log(std::string name = "room") {
    testing_support::Building building;
    building.add_box(0.0, 0.0, 10.0, 8.0);
    building.add_box(4.0, 3.0, 5.5, 5.0);
    building.add_box(0.0, 5.0, 1.5, 8.0);
    building.add_box(8.5, 0.0, 10.0, 1.0);
    std::vector<Point2> points;
    for (int round = 0; round < 2; ++round) {
        points.insert(points.end(), {{2.0, 1.5}, {7.5, 1.5}, {7.5, 6.5}, {2.5, 6.5}});
    }
    const slam::Drive drive = slam::drive_along(building, points, {.scale = 1.05, .turn = 0.035}, 7);
    const auto laser = std::make_shared<const Sensor>(drive.laser);
    DrivenLog driven{{.name = std::move(name)}, drive.truth};
    for (std::size_t n = 0; n < drive.scans.size(); ++n) {
        Scan scan = drive.scans[n];
        scan.stamp = 100.0 + 0.5 * static_cast<double>(n);
        scan.odometry = compose(kOdometryBegins, drive.odometry[n]);
        driven.log.scans.push_back({laser, scan});
    }
    for (std::size_t n = kBetweenRelated; n < drive.truth.size(); ++n) {
        driven.log.relations.push_back({driven.log.scans[n - kBetweenRelated].scan.stamp,
                                        driven.log.scans[n].scan.stamp,
                                        compose(inverse(drive.truth[n - kBetweenRelated]), drive.truth[n])});
    }
    return driven;
}

/// Returns the log as a CARMEN log: FLASER lines whose laser is at the robot.
inline std::string carmen_text(const RecordedLog& log) {
    std::string text;
    for (const auto& [sensor, scan] : log.scans) {
        text += fmt::format("FLASER {}", scan.ranges.size());
        for (const RangeMm range : scan.ranges)
            text += fmt::format(" {:.3f}", range == kNoReturn ? 81.91 : 1e-3 * range);
        const auto& [x, y, yaw] = *scan.odometry;
        const auto pose = fmt::format("{:.9f} {:.9f} {:.9f}", x, y, yaw);
        text += fmt::format(" {} {} {} host {}\n", pose, pose, scan.stamp, scan.stamp);
    }
    return text;
}

/// Returns the lines of a file of relations.
inline std::string relations_text(const RecordedLog& log) {
    std::string text;
    for (const auto& [from, to, pose] : log.relations) {
        text += fmt::format("{} {} {:.9f} {:.9f} 0 0 0 {:.9f}\n", from, to, pose.x, pose.y, pose.yaw);
    }
    return text;
}

} // namespace scanloom::lab

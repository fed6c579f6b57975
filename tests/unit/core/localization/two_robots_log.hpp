#pragma once

#include "core/localization/localized_projection.hpp"
#include "tests/unit/core/slam/drive.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace scanloom::localization {

/// Returns the log of a robot that sends its poses, and of one with odometry that starts when the first has taken
/// `head_start` scans. From then on both take turns.
inline std::vector<LogEntry> log_of_two(const slam::Drive& sender, const slam::Drive& follower,
                                        std::size_t head_start) {
    std::vector<LogEntry> log{RobotJoined{0, "sender"}, SensorDescribed{0, sender.laser},
                              RobotJoined{1, "follower", {}, {}, Poses::kOdometry}, SensorDescribed{1, follower.laser}};
    for (std::size_t n = 0; n < std::max(sender.scans.size(), follower.scans.size() + head_start); ++n) {
        if (n < sender.scans.size()) {
            Scan scan = sender.scans[n];
            scan.seq = n + 1;
            scan.pose = sender.truth[n];
            log.push_back(ScanTaken{0, scan});
        }
        if (n < head_start || n - head_start >= follower.scans.size()) continue;
        Scan scan = follower.scans[n - head_start];
        scan.seq = n - head_start + 1;
        scan.odometry = follower.odometry[n - head_start];
        log.push_back(ScanTaken{1, scan});
    }
    return log;
}

} // namespace scanloom::localization

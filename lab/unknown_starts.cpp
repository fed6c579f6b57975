#include "lab/unknown_starts.hpp"

#include "core/slam/trajectory_estimator.hpp"

#include <cmath>
#include <numbers>

namespace scanloom::lab {
namespace {

constexpr double kParts[] = {0.3, 0.4, 0.5, 0.6, 0.7, 0.8};

/// Lets the second robot take scans until it is located.
/// @param map    of the first robot
/// @param start  the second robot's first scan
std::optional<UnknownStart::Found> find_second(const RecordedLog& log, std::span<const robot::StampedPose> plain,
                                               slam::SharedMap& map, std::size_t start, Poses poses) {
    slam::TrajectoryEstimator second(map, 1);
    const Pose2 T_start_odom = inverse(*log.scans[start].scan.odometry);
    UnknownStart::Found found;
    for (std::size_t n = start; n < log.scans.size(); ++n) {
        Scan scan = log.scans[n].scan;
        if (n > start) {
            const Pose2 way = compose(inverse(*log.scans[n - 1].scan.odometry), *scan.odometry);
            found.path += std::hypot(way.x, way.y);
        }
        scan.odometry = poses == Poses::kOdometry ? std::optional(compose(T_start_odom, *scan.odometry)) : std::nullopt;
        second.add(scan, *log.scans[n].sensor);
        if (second.located_fragments() == 0) continue;
        const Pose2 off = compose(inverse(plain[n].robot), second.pose_of(n - start));
        found.scans = n - start + 1;
        found.metres = std::hypot(off.x, off.y);
        found.degrees = std::fabs(off.yaw) * 180.0 / std::numbers::pi;
        return found;
    }
    return std::nullopt;
}

} // namespace

std::vector<UnknownStart> start_anywhere(const RecordedLog& log, std::span<const robot::StampedPose> plain) {
    std::vector<UnknownStart> starts;
    for (const Poses poses : {Poses::kOdometry, Poses::kNone}) {
        for (const double part : kParts) {
            slam::SharedMap map;
            slam::TrajectoryEstimator first(map, 0);
            const auto start = static_cast<std::size_t>(part * static_cast<double>(log.scans.size()));
            for (std::size_t n = 0; n < start; ++n) first.add(log.scans[n].scan, *log.scans[n].sensor);
            starts.push_back({poses, part, find_second(log, plain, map, start, poses)});
        }
    }
    return starts;
}

} // namespace scanloom::lab

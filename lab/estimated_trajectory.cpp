#include "lab/estimated_trajectory.hpp"

#include "core/slam/trajectory_estimator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scanloom::lab {

Result<EstimatedTrajectory> estimate_trajectory(robot::Source& source, const std::function<double()>& cpu_seconds,
                                                const std::function<void(std::size_t scans)>& on_scan) {
    slam::SharedMap map;
    slam::TrajectoryEstimator estimator(map);
    EstimatedTrajectory trajectory;
    std::vector<double> stamps;
    for (;;) {
        const auto observation = source.next();
        if (!observation) return observation.error();
        if (!*observation) break;
        const auto& [sensor, scan] = **observation;
        if (sensor->kind != SensorKind::kLaser) continue;
        const double begun = cpu_seconds();
        estimator.add(scan, *sensor);
        trajectory.cpu_seconds += cpu_seconds() - begun;
        stamps.push_back(scan.stamp);
        on_scan(stamps.size());
    }
    if (stamps.empty()) return Error{Errc::kNotFound, "no scan is left; leave out fewer scans"};
    const double begun = cpu_seconds();
    estimator.finish();
    map.finish();
    trajectory.cpu_seconds += cpu_seconds() - begun;
    for (std::size_t i = 0; i < stamps.size(); ++i) {
        trajectory.final_poses.push_back({estimator.pose_of(i), stamps[i]});
        trajectory.first_poses.push_back({estimator.first_pose_of(i), stamps[i]});
        trajectory.is_located.push_back(estimator.is_located(i));
    }
    return trajectory;
}

std::string tum_text(std::vector<robot::StampedPose> poses) {
    std::ranges::stable_sort(poses, {}, &robot::StampedPose::stamp);
    std::string text;
    for (const auto& [robot, stamp] : poses) {
        fmt::format_to(std::back_inserter(text), "{:.6f} {:.6f} {:.6f} 0 0 0 {:.9f} {:.9f}\n", stamp, robot.x, robot.y,
                       std::sin(robot.yaw / 2.0), std::cos(robot.yaw / 2.0));
    }
    return text;
}

} // namespace scanloom::lab

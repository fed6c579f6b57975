#pragma once

#include "common/error/error.hpp"
#include "robot_client/sources/pose_path.hpp"
#include "robot_client/sources/source.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace scanloom::lab {

/// The poses that were estimated for the scans of a source, T_map_robot, in the order of the source.
struct EstimatedTrajectory {
    std::vector<robot::StampedPose> final_poses; ///< after the last scan
    std::vector<robot::StampedPose> first_poses; ///< each as estimated when its scan was added
    std::vector<bool>
        is_located;           ///< whether the scan's pose is known; otherwise it is a prediction or in another frame
    double cpu_seconds = 0.0; ///< of all threads of the process, for the estimation; without reading the scans
};

/// Estimates where the scans of a source were taken, from their readings and their odometry, if they have any. Their
/// poses are not used, nor are scans of sonars.
/// @param cpu_seconds  returns the CPU time of the process in seconds
/// @param on_scan      called after each scan with the number of scans so far
/// Errors: those of the source; kNotFound if it has no scans.
[[nodiscard]] Result<EstimatedTrajectory> estimate_trajectory(robot::Source& source,
                                                              const std::function<double()>& cpu_seconds,
                                                              const std::function<void(std::size_t scans)>& on_scan);

/// Formats poses in the TUM format, by increasing stamp: a line `stamp x y z qx qy qz qw` for each pose, in seconds
/// with six decimals, metres, and a unit quaternion.
[[nodiscard]] std::string tum_text(std::vector<robot::StampedPose> poses);

} // namespace scanloom::lab

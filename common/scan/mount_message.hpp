#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

namespace scanloom {

/// Returns what is wrong with the mount of a laser, as the end of a sentence.
/// @param yaw_error  radians: by how much the yaw of the mount seems to be too large
[[nodiscard]] inline std::string mount_message(double yaw_error) {
    return fmt::format("the yaw of the laser's mount seems to be {:.0f} degrees too {}, because scans and odometry "
                       "disagree about the direction of motion; correct the mount, or the axes of the odometry",
                       std::fabs(yaw_error) * 180.0 / std::numbers::pi, yaw_error < 0.0 ? "small" : "large");
}

} // namespace scanloom

#pragma once

#include "robot_client/app/lidar_options.hpp"
#include "robot_client/app/make_source.hpp"

namespace scanloom::robot {

/// Prepares a live source for the lidar, or opens the capture file. Reports the first invalid lines of poses and later
/// events of a device to the console, which must outlive the source.
/// Pre: complaint_about() has none about the options.
/// Errors: as for make_source().
[[nodiscard]] Result<PreparedSource> make_lidar(const RobotOptions& options, const LidarOptions& lidar,
                                                Console& console);

} // namespace scanloom::robot

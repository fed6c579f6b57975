#pragma once

#include "robot_client/app/make_source.hpp"

namespace scanloom::robot {

/// Opens a capture file or prepares a live source for a device. Reports the first invalid lines of poses, and later
/// events of a device, to the console, which must outlive the source.
/// Errors: those of Ld06Capture::open() and read_pose_lines(); kNotFound if the device does not exist; kInvalidField if
///         options contradict each other or a spool is given for a capture file.
[[nodiscard]] Result<PreparedSource> prepare_ld06(const RobotOptions& options, const Ld06Options& ld06,
                                                  Console& console);

} // namespace scanloom::robot

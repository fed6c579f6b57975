#pragma once

#include "robot_client/app/make_source.hpp"

namespace scanloom::robot {

/// Opens a capture file, or prepares a live source for a device. What is wrong with lines of poses, the first few, is
/// told to the console, and so is, later, what happens to a device; it must outlive the source.
/// Errors  those of Ld06Capture::open() and read_pose_lines(); kNotFound: no such device; kInvalidField: options that
///         contradict each other, and a spool for a capture file.
[[nodiscard]] Result<PreparedSource> prepare_ld06(const RobotOptions& options, const Ld06Options& ld06,
                                                  Console& console);

} // namespace scanloom::robot

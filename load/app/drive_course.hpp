#pragma once

#include "common/error/error.hpp"
#include "load/app/options.hpp"
#include "load/core/course.hpp"

namespace scanloom::load {

/// Drives a simulated robot along the walls of the world and prepares its scans, options.course of them, or as many as
/// each robot is going to send where these are fewer.
/// Errors  those of load_world() and find_laser(); kTooLarge: --batch scans of this laser exceed a frame.
[[nodiscard]] Result<Course> drive_course(const LoadOptions& options);

} // namespace scanloom::load

#pragma once

#include "common/app/program.hpp"
#include "robot_client/app/options.hpp"

namespace scanloom::robot {

/// Streams until every scan is durable, or until SIGINT or SIGTERM. Writes progress and errors to stderr and the
/// summary to stdout.
[[nodiscard]] ExitCode run(const RobotOptions& options);

} // namespace scanloom::robot

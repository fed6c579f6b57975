#pragma once

#include "common/app/program.hpp"
#include "robot_client/app/options.hpp"

namespace scanloom::robot {

/// Streams until every scan is durable, SIGINT or SIGTERM. Progress and errors go to stderr, the summary to stdout.
[[nodiscard]] ExitCode run(const RobotOptions& options);

} // namespace scanloom::robot

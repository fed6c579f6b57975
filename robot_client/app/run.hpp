#pragma once

#include "common/app/program.hpp"

namespace scanloom::robot {

struct RobotOptions;

/// Streams until every scan is durable, or until SIGINT or SIGTERM. Writes progress and errors to stderr and the
/// summary to stdout.
[[nodiscard]] ExitCode run(const RobotOptions& options);

/// Runs the command given on the command line. Prints help and the version to stdout.
/// @return kExitDone, kExitFailed, or kExitUsage if an argument, the environment or the configuration file is invalid
[[nodiscard]] ExitCode run(int argc, const char* const* argv);

} // namespace scanloom::robot

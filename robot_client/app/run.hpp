#pragma once

#include "common/app/program.hpp"

namespace scanloom::robot {

struct RobotOptions;

/// Streams until every scan is durable, or until SIGINT or SIGTERM. Writes progress and errors to stderr and the
/// summary to stdout.
[[nodiscard]] ExitCode run(const RobotOptions& options);

/// Runs the command that the arguments of the program name, or writes why it cannot to stderr.
[[nodiscard]] ExitCode run(int argc, const char* const* argv);

} // namespace scanloom::robot

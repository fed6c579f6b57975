#pragma once

namespace scanloom::app {

/// Runs the task given on the command line and logs to standard error: serves until a signal ends it, or checks,
/// repairs, restores or copies a store. Prints help and the version to standard output. Ignores SIGHUP until the server
/// handles it.
/// @return kExitDone, kExitFailed, or kExitUsage if an argument, the environment or the configuration file is invalid
[[nodiscard]] int run(int argc, const char* const* argv);

} // namespace scanloom::app

#pragma once

#include "server/app/options.hpp"

namespace scanloom::app {

/// Does the task of the options, and logs to standard error: serves until a signal ends it, or checks, repairs or
/// restores a store.
/// @return exit code of the program
int run(const ServerOptions& options);

} // namespace scanloom::app

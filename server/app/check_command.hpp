#pragma once

#include "common/app/program.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// Runs `scanloom-server --check`: reads all of a store that no server has open, without changing it.
///
/// Prints one line per session and a final line of JSON to standard output, and its progress to standard error.
/// @return kExitFailed if anything is damaged or the store cannot be read
[[nodiscard]] ExitCode check_store(const ServerOptions& options);

} // namespace scanloom::app

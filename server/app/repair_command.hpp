#pragma once

#include "common/app/program.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// Runs `scanloom-server --repair NEW --store OLD`: writes the intact parts of OLD to NEW, without changing OLD.
///
/// Prints one line per session and a final line of JSON.
/// @return kExitFailed if NEW could not be created; lost entries are not a failure
[[nodiscard]] ExitCode repair_store(const ServerOptions& options);

} // namespace scanloom::app

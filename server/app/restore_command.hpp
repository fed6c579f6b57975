#pragma once

#include "common/app/program.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// Runs `scanloom-server --restore ID`: writes the store of a backup to an empty directory, and prints a line of JSON.
/// @return kExitFailed if the store could not be restored
[[nodiscard]] ExitCode restore_store(const ServerOptions& options);

} // namespace scanloom::app

#pragma once

#include "common/app/program.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// `scanloom-server --restore ID`: writes a store as a backup has it into an empty directory, and says so in a line of
/// JSON.
[[nodiscard]] ExitCode restore_store(const ServerOptions& options);

} // namespace scanloom::app

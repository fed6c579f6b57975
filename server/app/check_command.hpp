#pragma once

#include "common/app/program.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// `scanloom-server --check`: reads all of a store that no server has open, and changes nothing of it. Says a line a
/// session on standard output, at the end one of JSON; how far it is goes to standard error.
/// @return kExitFailed where anything is damaged or the store cannot be read.
[[nodiscard]] ExitCode check_store(const ServerOptions& options);

} // namespace scanloom::app

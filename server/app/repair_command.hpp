#pragma once

#include "common/app/program.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// `scanloom-server --repair NEW --store OLD`: writes whatever is intact of OLD into NEW, and changes nothing of OLD.
/// Says a line a session, and at the end one of JSON.
/// @return kExitFailed where NEW could not be made; loss is no failure.
[[nodiscard]] ExitCode repair_store(const ServerOptions& options);

} // namespace scanloom::app

#pragma once

#include "common/app/program.hpp"
#include "server/app/options.hpp"

/// The tasks of scanloom-server for a store that no server has open. Each ends with a line of JSON on standard output.
namespace scanloom::app {

/// Runs `scanloom-server --check`: reads a whole store without changing it. Prints one line per session, and its
/// progress to standard error.
/// @return kExitFailed if anything is damaged or the store cannot be read
[[nodiscard]] ExitCode check_store(const ServerOptions& options);

/// Runs `scanloom-server --repair NEW --store OLD`: writes the intact parts of OLD to NEW, without changing OLD. Prints
/// one line per session.
/// @return kExitFailed if NEW could not be created; lost entries are not a failure
[[nodiscard]] ExitCode repair_store(const ServerOptions& options);

/// Runs `scanloom-server --copy FROM --to TO`: copies all sessions, without changing FROM. Prints one line per session.
/// @return kExitFailed if TO could not be created or written, or something of FROM is damaged
[[nodiscard]] ExitCode copy_store(const ServerOptions& options);

/// Runs `scanloom-server --restore ID`: writes the store of a backup to an empty directory.
/// @return kExitFailed if the store could not be restored
[[nodiscard]] ExitCode restore_store(const ServerOptions& options);

} // namespace scanloom::app

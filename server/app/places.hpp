#pragma once

#include "common/error/error.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// Checks that the store, its repaired copy and its backups are separate directories, none inside another, so that
/// files written to one cannot get among the files of another. Follows symbolic links.
/// Errors: kInvalidField if two of them are the same, or one contains another.
[[nodiscard]] Result<> check_places(const ServerOptions& options);

} // namespace scanloom::app

#pragma once

#include "common/error/error.hpp"
#include "server/app/options.hpp"

namespace scanloom::app {

/// A store, what it is repaired into, and its backups are three places, none within another: what is written to one
/// would lie among the files of the other. Symbolic links are followed.
/// Errors  kInvalidField.
[[nodiscard]] Result<> check_places(const ServerOptions& options);

} // namespace scanloom::app

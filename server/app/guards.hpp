#pragma once

#include "common/error/error.hpp"
#include "server/app/options.hpp"

#include <string>
#include <vector>

namespace scanloom::app {

/// Checks that every port that other machines can reach is protected, unless --insecure is given.
/// Errors: kInvalidField if an endpoint is not on loopback and has neither tokens nor TLS.
[[nodiscard]] Result<> check_guarded(const ServerOptions& options);

/// Returns warnings for the operator, one sentence each, about access that the settings leave open to others.
[[nodiscard]] std::vector<std::string> guard_warnings(const ServerOptions& options);

} // namespace scanloom::app

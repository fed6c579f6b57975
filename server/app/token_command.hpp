#pragma once

#include "common/app/program.hpp"

#include <optional>

namespace scanloom::app {

/// `scanloom-server token ...`: makes a secret and says once what it is, with the lines for the file of --tokens.
/// Nothing where another thing was asked for.
[[nodiscard]] std::optional<Leave> token_command(int argc, const char* const* argv);

} // namespace scanloom::app

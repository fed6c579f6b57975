#pragma once

#include "common/app/program.hpp"

#include <optional>

namespace scanloom::app {

/// Runs `scanloom-server token ...`: creates a secret, and returns it as text to print once, with the lines for the
/// file of --tokens.
/// @return nullopt if the first argument is not `token`
[[nodiscard]] std::optional<Leave> token_command(int argc, const char* const* argv);

} // namespace scanloom::app

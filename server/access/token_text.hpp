#pragma once

#include "common/error/error.hpp"
#include "server/access/token_set.hpp"

#include <string>
#include <string_view>

/// Tokens as text, in TOML.
namespace scanloom::access {

/// Reads what --tokens names:
///
///     [[token]]
///     name = "depot-robots"
///     sha256 = "9f86d081..."                # of the secret
///     role = "robot"                        # or viewer, operator
///     sessions = ["depot-*", "test"]        # patterns
///     limits = { connections = 8, sensors = 4 }   # those of Limits; what is left out has its default
///
/// Errors  kMalformed: no TOML; kInvalidField: a key that is missing, unknown or wrong, a name or hash that is there
///         twice. The message begins with the line's number and a colon.
[[nodiscard]] Result<TokenSet> parse_tokens(std::string_view toml);

/// The lines to add for it; limits as they are by themselves are left out.
[[nodiscard]] std::string text_of(const Token& token);

} // namespace scanloom::access

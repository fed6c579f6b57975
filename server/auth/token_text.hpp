#pragma once

#include "common/error/error.hpp"
#include "server/auth/token.hpp"

#include <string>
#include <string_view>

namespace scanloom::auth {

/// Parses the file of --tokens, which is TOML:
///
///     [[token]]
///     name = "depot-robots"
///     sha256 = "9f86d081..."                # of the secret
///     role = "robot"                        # or viewer, operator
///     sessions = ["depot-*", "test"]        # patterns
///     limits = { connections = 8, sensors = 4 }   # the members of Limits; omitted ones have their defaults
///
/// Errors: kMalformed if the text is not TOML or has non-ASCII characters outside comments; kInvalidField if it has no
///         [[token]] or more than 10 000, if a key is missing, unknown or has an invalid value, or if two tokens have
///         the same name or hash. The message begins with the line number and a colon.
[[nodiscard]] Result<TokenSet> parse_tokens(std::string_view toml);

/// Returns the lines that add the token to the file. Limits equal to their defaults are omitted.
[[nodiscard]] std::string text_of(const Token& token);

} // namespace scanloom::auth

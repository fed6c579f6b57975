#pragma once

#include "common/error/error.hpp"
#include "server/auth/token.hpp"

#include <filesystem>

namespace scanloom::auth {

/// Reads the file of --tokens, in the format of parse_tokens().
/// Errors: kNotFound if the path cannot be read or is not a regular file; kInvalidField if users other than its owner
///         may write to it, and so grant themselves access; kTooLarge if it is larger than 4 MiB; those of
///         parse_tokens(). The message begins with the path.
[[nodiscard]] Result<TokenSet> read_tokens(const std::filesystem::path& path);

} // namespace scanloom::auth

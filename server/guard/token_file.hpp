#pragma once

#include "common/error/error.hpp"
#include "server/access/token_set.hpp"

#include <filesystem>

namespace scanloom::guard {

/// Reads the file of --tokens, as access::parse_tokens() describes it.
/// Errors  kNotFound: it cannot be read; kInvalidField: others than its owner may write to it, and so let themselves in;
///         kTooLarge: more than 4 MiB; those of parse_tokens(). The message begins with the path.
[[nodiscard]] Result<access::TokenSet> read_tokens(const std::filesystem::path& path);

} // namespace scanloom::guard

#pragma once

#include "common/error/error.hpp"

#include <string>

namespace scanloom {

/// The first line of a token file; empty where no file is named.
/// Errors  kNotFound: it cannot be read, or its first line is empty.
[[nodiscard]] Result<std::string> read_token(const std::string& path);

} // namespace scanloom

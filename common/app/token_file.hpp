#pragma once

#include "common/error/error.hpp"

#include <string>

namespace scanloom {

/// Reads the first line of a token file; returns an empty string if `path` is empty.
/// Errors: kNotFound if the file cannot be read or its first line is empty.
[[nodiscard]] Result<std::string> read_token(const std::string& path);

} // namespace scanloom

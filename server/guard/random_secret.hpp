#pragma once

#include <string>

namespace scanloom::guard {

/// Creates a secret from 256 random bits of the system.
/// Errors: std::runtime_error if the system has none.
[[nodiscard]] std::string random_secret();

} // namespace scanloom::guard

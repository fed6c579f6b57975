#pragma once

#include <string>

namespace scanloom::guard {

/// A new secret, of 256 random bits of the system.
/// Errors  std::runtime_error: the system has none.
[[nodiscard]] std::string random_secret();

} // namespace scanloom::guard

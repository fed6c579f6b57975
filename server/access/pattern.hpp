#pragma once

#include <string_view>

/// Patterns of session names: '*' matches any text, including the empty text, '?' matches one character, and any other
/// character matches itself.
namespace scanloom::access {

/// Returns whether the pattern has 1 to 64 characters of A-Z a-z 0-9 _ - * ?
[[nodiscard]] bool is_valid_pattern(std::string_view pattern) noexcept;

/// Returns whether the whole name matches the pattern.
/// Cost: at most the product of the two lengths, for every pattern.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name) noexcept;

} // namespace scanloom::access

#pragma once

#include <string_view>

/// Patterns of sessions' names: '*' stands for any text, also none, '?' for one character, all else for itself.
namespace scanloom::access {

/// 1 to 64 characters of A-Z a-z 0-9 _ - * ?
[[nodiscard]] bool is_valid_pattern(std::string_view pattern) noexcept;

/// Cost  the product of the lengths at most, whatever the pattern.
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name) noexcept;

} // namespace scanloom::access

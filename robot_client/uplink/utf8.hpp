#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace scanloom::robot {

struct Character {
    char32_t value = 0;
    std::size_t size = 0; ///< bytes
};

/// Returns the first character of a UTF-8 text, or nullopt if the text is empty or does not begin with valid UTF-8.
[[nodiscard]] std::optional<Character> first_character(std::string_view text);

[[nodiscard]] bool is_utf8(std::string_view text);

} // namespace scanloom::robot

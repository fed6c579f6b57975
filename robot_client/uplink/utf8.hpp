#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace scanloom::robot {

struct Character {
    char32_t value = 0;
    std::size_t size = 0; ///< bytes
};

/// The character at the front of a text in UTF-8; nothing where there is none, or bytes that are no such text.
[[nodiscard]] std::optional<Character> first_character(std::string_view text);

[[nodiscard]] bool is_utf8(std::string_view text);

} // namespace scanloom::robot

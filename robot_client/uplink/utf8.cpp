#include "robot_client/uplink/utf8.hpp"

#include <array>

namespace scanloom::robot {
namespace {

unsigned char byte_at(std::string_view text, std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

} // namespace

std::optional<Character> first_character(std::string_view text) {
    if (text.empty()) return std::nullopt;
    const unsigned char first = byte_at(text, 0);
    if (first < 0x80) return Character{first, 1};
    const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    char32_t character = first & (0x7fU >> size);
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte_at(text, i) & 0xc0) != 0x80) return std::nullopt;
        character = character << 6 | (byte_at(text, i) & 0x3fU);
    }
    // Reject overlong encodings: they would be another way to write smaller characters, including controls.
    constexpr std::array<char32_t, 5> kSmallest{0, 0, 0x80, 0x800, 0x10000};
    const bool is_text = first >= 0xc0 && first < 0xf8 && character >= kSmallest[size] && character <= 0x10ffff &&
                         (character < 0xd800 || character > 0xdfff);
    if (!is_text) return std::nullopt;
    return Character{character, size};
}

bool is_utf8(std::string_view text) {
    while (!text.empty()) {
        const auto first = first_character(text);
        if (!first) return false;
        text.remove_prefix(first->size);
    }
    return true;
}

} // namespace scanloom::robot

#include "common/link/printable_text.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>

namespace scanloom::link {
namespace {

struct Character {
    char32_t value = 0;
    std::size_t size = 0; ///< bytes
};

unsigned char byte_at(std::string_view text, std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

/// Returns the first character of a UTF-8 text, or nullopt if the text is empty or does not begin with valid UTF-8.
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

/// Returns whether a character is not displayed itself but changes how the text is displayed.
/// Source: Unicode 15: general categories Cc, Zl and Zp, and the property Bidi_Control.
bool is_control(char32_t c) {
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x061c || c == 0x200e || c == 0x200f ||
           (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/// Returns the size in bytes of the printable UTF-8 character at the front of `text`, or 0 if there is none.
std::size_t printable_size(std::string_view text) {
    const auto first = first_character(text);
    return first && !is_control(first->value) ? first->size : 0;
}

} // namespace

bool is_utf8(std::string_view text) {
    while (!text.empty()) {
        const auto first = first_character(text);
        if (!first) return false;
        text.remove_prefix(first->size);
    }
    return true;
}

std::string printable(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t size = printable_size(text);
        std::string next(text.substr(0, size));
        if (size == 0) next = fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
        if (out.size() + next.size() > kPrintableTextMax) return out + "...";
        out += next;
        text.remove_prefix(size == 0 ? 1 : size);
    }
    return out;
}

} // namespace scanloom::link

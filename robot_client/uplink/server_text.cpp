#include "robot_client/uplink/server_text.hpp"

#include <fmt/format.h>

#include <array>

namespace scanloom::robot {
namespace {

unsigned char byte_at(std::string_view text, std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

/// Characters that do not stand in the text but change how it is shown.
/// Source  Unicode 15: general categories Cc, Zl and Zp, and the property Bidi_Control.
bool is_control(char32_t c) {
    return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x061c || c == 0x200e || c == 0x200f ||
           (c >= 0x2028 && c <= 0x202e) || (c >= 0x2066 && c <= 0x2069);
}

/// Bytes of the printable UTF-8 character at the front of `text`; 0 where there is none.
std::size_t printable_size(std::string_view text) {
    const unsigned char first = byte_at(text, 0);
    if (first < 0x80) return is_control(first) ? 0 : 1;
    const std::size_t size = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
    char32_t character = first & (0x7fU >> size);
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte_at(text, i) & 0xc0) != 0x80) return 0;
        character = character << 6 | (byte_at(text, i) & 0x3fU);
    }
    // Longer than needed would be another way to write smaller characters, controls among them.
    constexpr std::array<char32_t, 5> kSmallest{0, 0, 0x80, 0x800, 0x10000};
    const bool is_text = first >= 0xc0 && first < 0xf8 && character >= kSmallest[size] && character <= 0x10ffff &&
                         (character < 0xd800 || character > 0xdfff);
    return is_text && !is_control(character) ? size : 0;
}

} // namespace

std::string shown(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t size = printable_size(text);
        std::string next(text.substr(0, size));
        if (size == 0) next = fmt::format("\\x{:02x}", byte_at(text, 0));
        if (out.size() + next.size() > kServerTextMax) return out + "...";
        out += next;
        text.remove_prefix(size == 0 ? 1 : size);
    }
    return out;
}

} // namespace scanloom::robot

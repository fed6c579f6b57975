#include "robot_client/uplink/server_text.hpp"

#include "robot_client/uplink/utf8.hpp"

#include <fmt/format.h>

namespace scanloom::robot {
namespace {

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

std::string shown(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t size = printable_size(text);
        std::string next(text.substr(0, size));
        if (size == 0) next = fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
        if (out.size() + next.size() > kServerTextMax) return out + "...";
        out += next;
        text.remove_prefix(size == 0 ? 1 : size);
    }
    return out;
}

} // namespace scanloom::robot

#include "common/link/printable_text.hpp"

#include <boost/locale/utf.hpp>
#include <fmt/format.h>

#include <optional>

namespace scanloom::link {
namespace {

namespace utf = boost::locale::utf;

struct Character {
    utf::code_point value = 0;
    std::size_t size = 0; ///< bytes
};

/// Returns the first character of a UTF-8 text, or nullopt if the text is empty or does not begin with valid UTF-8.
/// Overlong encodings are invalid: they would be another way to write smaller characters, including controls.
std::optional<Character> first_character(std::string_view text) {
    const char* next = text.data();
    const auto value = utf::utf_traits<char>::decode(next, text.data() + text.size());
    if (value == utf::illegal || value == utf::incomplete) return std::nullopt;
    return Character{value, static_cast<std::size_t>(next - text.data())};
}

/// Returns whether a character is not displayed itself but changes how the text is displayed.
/// Source: Unicode 15: general categories Cc, Zl and Zp, and the property Bidi_Control.
bool is_control(utf::code_point c) {
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

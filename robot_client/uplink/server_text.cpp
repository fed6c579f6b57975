#include "robot_client/uplink/server_text.hpp"

#include <fmt/format.h>

#include <iterator>

namespace scanloom::robot {
namespace {

unsigned char byte_at(std::string_view text, std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

/// Bytes of the printable UTF-8 character at the front of `text`; 0 where there is none.
std::size_t printable_size(std::string_view text) {
    const unsigned char first = byte_at(text, 0);
    const unsigned char second = byte_at(text, 1);
    if (first >= 0x20 && first < 0x7f) return 1;
    // Two bytes from U+00A0 on: U+0080 to U+009F are the control characters C1.
    if (first >= 0xc2 && first <= 0xdf) return (second & 0xc0) == 0x80 && (first != 0xc2 || second >= 0xa0) ? 2 : 0;
    std::size_t size = 0;
    if (first >= 0xe0 && first <= 0xef) size = 3;
    if (first >= 0xf0 && first <= 0xf4) size = 4;
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte_at(text, i) & 0xc0) != 0x80) return 0;
    }
    // Longer than needed would be another way to write the characters above.
    if ((first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90)) return 0;
    return size;
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

#pragma once

#include <string>
#include <string_view>

namespace scanloom::testing_support {

/// Appends a frame without a checksum, as of programs that send none: the length, big-endian, and the body.
inline void append_plain_frame(std::string& out, std::string_view body) {
    for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(body.size() >> shift & 0xff);
    out += body;
}

} // namespace scanloom::testing_support

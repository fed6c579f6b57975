#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace scanloom::link {

/// Returns whether a text is valid UTF-8, without overlong encodings and surrogates.
/// @param text  any bytes
[[nodiscard]] bool is_utf8(std::string_view text);

inline constexpr std::size_t kPrintableTextMax = 500; ///< bytes of a peer's text that are shown

/// Makes text from a peer safe for a terminal and a log file. Control characters (C0, DEL, C1), characters that
/// change the text's direction or end a line (such as U+2028 and U+202E), and bytes that are not UTF-8 become `\xNN`; a
/// backslash stays. Text after kPrintableTextMax bytes is replaced by "...".
/// @param text  any bytes
[[nodiscard]] std::string printable(std::string_view text);

} // namespace scanloom::link

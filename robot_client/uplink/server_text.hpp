#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace scanloom::robot {

inline constexpr std::size_t kServerTextMax = 500; ///< bytes of a server's text that are shown

/// Makes text from a server safe for a terminal and a log file. Control characters (C0, DEL, C1), characters that
/// change the text's direction or end a line (such as U+2028 and U+202E), and bytes that are not UTF-8 become \xNN; a
/// backslash stays. Text after kServerTextMax bytes is replaced by "...".
[[nodiscard]] std::string shown(std::string_view text);

} // namespace scanloom::robot

#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace scanloom::robot {

inline constexpr std::size_t kServerTextMax = 500; ///< bytes of a server's text that are shown

/// Text of a server, fit for a terminal and a log file: control characters (C0, DEL, C1), those that turn the direction
/// of the text or end a line (U+2028, U+202E and their like), and bytes that are no UTF-8 are written as \xNN, a
/// backslash stays; what exceeds kServerTextMax bytes is cut off and marked with "...".
[[nodiscard]] std::string shown(std::string_view text);

} // namespace scanloom::robot

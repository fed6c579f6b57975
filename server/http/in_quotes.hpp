#pragma once

#include <string>
#include <string_view>

namespace scanloom::http {

/// What a stranger sent, fit for a message or a line of the log: in quotes, at most 64 characters
/// of it, everything but printable ASCII as '?'.
[[nodiscard]] std::string in_quotes(std::string_view text);

} // namespace scanloom::http

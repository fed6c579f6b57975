#pragma once

#include <string>
#include <string_view>

namespace scanloom::http {

/// Quotes untrusted text for a message or a log line: at most 64 characters, with '?' for everything but printable
/// ASCII.
[[nodiscard]] std::string in_quotes(std::string_view text);

} // namespace scanloom::http

#pragma once

#include <ctime>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Formats a time as an IMF-fixdate: "Sun, 06 Nov 1994 08:49:37 GMT".
/// Source: RFC 9110, section 5.6.7.
[[nodiscard]] std::string date_of(std::time_t time);

/// Returns date_of() the current time, formatted once a second. The view is valid until the next call on this thread.
[[nodiscard]] std::string_view date_now();

} // namespace scanloom::http

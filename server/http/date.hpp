#pragma once

#include <ctime>
#include <string>
#include <string_view>

namespace scanloom::http {

/// An IMF-fixdate: "Sun, 06 Nov 1994 08:49:37 GMT".
/// Source  RFC 9110, section 5.6.7.
[[nodiscard]] std::string date_of(std::time_t time);

/// That of now, written once a second. Valid until the thread asks again.
[[nodiscard]] std::string_view date_now();

} // namespace scanloom::http

#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Credentials in the header fields of a request.
namespace scanloom::http {

inline constexpr std::string_view kLoginCookie = "scanloom_login";

/// Returns the token of an Authorization field "Bearer TOKEN" (RFC 6750, section 2.1), or nullopt for another form.
[[nodiscard]] std::optional<std::string_view> bearer_of(std::string_view authorization) noexcept;

/// Returns the value of the first cookie called `name` in a Cookie field (RFC 6265, section 4.2).
[[nodiscard]] std::optional<std::string_view> cookie_of(std::string_view cookie_field, std::string_view name) noexcept;

/// Returns a Set-Cookie field that restricts the cookie to this server's own pages and hides it from scripts.
/// @param value      empty to delete the cookie
/// @param is_secure  whether the browser sends it over TLS only
[[nodiscard]] std::string set_login_cookie(std::string_view value, bool is_secure);

} // namespace scanloom::http

#pragma once

#include <optional>
#include <string>
#include <string_view>

/// How somebody says who he is, in a request's fields.
namespace scanloom::http {

inline constexpr std::string_view kLoginCookie = "scanloom_login";

/// The token of an Authorization field "Bearer TOKEN" (RFC 6750, section 2.1); nothing when it is of another form.
[[nodiscard]] std::optional<std::string_view> bearer_of(std::string_view authorization) noexcept;

/// The value of the cookie of that name in a Cookie field (RFC 6265, section 4.2), the first if there are several.
[[nodiscard]] std::optional<std::string_view> cookie_of(std::string_view cookie_field, std::string_view name) noexcept;

/// A Set-Cookie field: for this server's own pages alone, and hidden from scripts. An empty value takes it away.
/// `is_secure`: only over TLS.
[[nodiscard]] std::string set_login_cookie(std::string_view value, bool is_secure);

} // namespace scanloom::http

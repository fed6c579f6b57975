#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Parses the header fields of requests, and writes those that depend on them.
namespace scanloom::http {

// Host and Origin

/// Returns whether a Host field names this server: "localhost", an IP address, or one of `names`, with or without a
/// port, in any case.
///
/// A foreign page can resolve a host name of its own to this server's address and would then count as the same origin
/// (DNS rebinding). The host name reveals such a page.
[[nodiscard]] bool is_known_host(std::string_view host_field, const std::vector<std::string>& names);

/// Returns whether a page of `origin` ("http://localhost:8080") belongs to this server: its host and port equal those
/// of the Host field (RFC 6454). A missing port stands for that of the origin's scheme (80, 443). Another port of the
/// same host is another program. A proxy must forward the Host field unchanged.
/// @param host_field  passed is_known_host()
/// @param is_secure   whether the request came over TLS; then the page must have, too, since others on the network can
///                    forge a page without TLS
[[nodiscard]] bool is_own_page(std::string_view origin, std::string_view host_field, bool is_secure);

/// Returns whether `key` is valid for a WebSocket handshake: 16 bytes in base64.
[[nodiscard]] bool is_websocket_key(std::string_view key) noexcept;

/// Returns the WebSocket addresses of this server for a Content-Security-Policy: "ws://localhost:8080
/// wss://localhost:8080", or only the second one over TLS (`is_secure`). Empty if the Host field is not usable.
[[nodiscard]] std::string websocket_sources(std::string_view host_field, bool is_secure);

// Authorization and Cookie

inline constexpr std::string_view kLoginCookie = "scanloom_login";

/// Returns the token of an Authorization field "Bearer TOKEN" (RFC 6750, section 2.1), or nullopt for another form.
[[nodiscard]] std::optional<std::string_view> bearer_of(std::string_view authorization) noexcept;

/// Returns the value of the first cookie called `name` in a Cookie field (RFC 6265, section 4.2).
[[nodiscard]] std::optional<std::string_view> cookie_of(std::string_view cookie_field, std::string_view name) noexcept;

/// Returns a Set-Cookie field that restricts the cookie to this server's own pages and hides it from scripts.
/// @param value      empty to delete the cookie
/// @param is_secure  whether the browser sends it over TLS only
[[nodiscard]] std::string set_login_cookie(std::string_view value, bool is_secure);

// If-None-Match

/// Returns whether an If-None-Match field contains `etag`.
///
/// @param field  "*" or a list of entity tags, compared weakly (W/ is ignored); a malformed field matches nothing, so
///               that the response is sent in full
/// @param etag   an entity tag with its quotes
/// Source: RFC 9110, sections 8.8.3.2 and 13.1.2.
[[nodiscard]] bool if_none_match_has(std::string_view field, std::string_view etag);

} // namespace scanloom::http

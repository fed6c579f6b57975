#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace scanloom::http {

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

} // namespace scanloom::http

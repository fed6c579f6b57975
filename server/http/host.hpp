#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace scanloom::http {

/// Whether a Host field names this server: "localhost", an address (not a name), or one of `names`,
/// with or without a port, in any case.
///
/// A page of a stranger can point a name of its own at this server's address and would then count
/// as the same origin (DNS rebinding). Its name gives it away.
[[nodiscard]] bool is_known_host(std::string_view host_field, const std::vector<std::string>& names);

/// Whether a page of that origin ("http://localhost:8080") may use what only pages of this server may: host and port
/// are those of the Host field (RFC 6454), where the port of the origin's scheme (80, 443) stands for one that is not
/// given. Another port of the same host is another program. Where the request came over TLS (`is_secure`), the page
/// must have, too: others on the network can forge a page without it. A proxy must pass the Host field on unchanged.
/// Pre  the Host field is one of a known host.
[[nodiscard]] bool is_own_page(std::string_view origin, std::string_view host_field, bool is_secure);

/// Whether it is what a WebSocket's handshake asks for: 16 bytes in base64.
[[nodiscard]] bool is_websocket_key(std::string_view key) noexcept;

/// The Host field as an address of the WebSockets of this server in a Content-Security-Policy: "ws://localhost:8080
/// wss://localhost:8080", of which the second alone where it is asked over TLS; empty where it cannot be one.
[[nodiscard]] std::string websocket_sources(std::string_view host_field, bool is_secure);

} // namespace scanloom::http

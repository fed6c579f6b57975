#pragma once

#include <optional>
#include <string>

namespace scanloom::http {

/// The fields of a WebSocket handshake (RFC 6455, section 4.1), unchecked; empty if absent.
struct WebSocketUpgrade {
    std::string version;
    std::string key;
    std::string origin;
    std::string protocols; ///< all Sec-WebSocket-Protocol fields, joined with commas
};

/// A request as received. Only its HTTP syntax has been checked. Any part of it may contain secrets.
struct Request {
    std::string method = "GET";
    std::string target = "/";
    std::string host;            ///< empty when absent
    std::string content_type;    ///< empty when absent
    std::string accept_encoding; ///< all such fields, joined with commas; empty when absent
    std::string if_none_match;   ///< all such fields, joined with commas; empty when absent
    std::string authorization;   ///< empty when absent, as the next two
    std::string cookie;
    std::string origin;
    std::string body;
    std::optional<WebSocketUpgrade> upgrade; ///< set if the request asks for a WebSocket
    std::string peer;                        ///< the client's address, without a port
    bool is_secure = false;                  ///< received over TLS
    bool is_forwarded = false;               ///< another server that shares the database has passed it on
    bool is_of_viewer_page = false;          ///< its origin is one of ServerConfig::viewer_origins
};

} // namespace scanloom::http

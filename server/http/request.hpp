#pragma once

#include <optional>
#include <string>

namespace scanloom::http {

/// What whoever wants to go on with a WebSocket says (RFC 6455, section 4.1), unchecked; empty: not said.
struct WebSocketUpgrade {
    std::string version;
    std::string key;
    std::string origin;
};

/// A request as it arrived: nothing in it has been checked but that it is HTTP. Secrets may be anywhere in it.
struct Request {
    std::string method = "GET";
    std::string target = "/";
    std::string host;            ///< empty when absent
    std::string content_type;    ///< empty when absent
    std::string accept_encoding; ///< all such fields, joined with commas; empty when absent
    std::string if_none_match;   ///< all such fields, joined with commas; empty when absent
    std::string authorization;   ///< empty when absent, as the two below
    std::string cookie;
    std::string origin;
    std::string body;
    std::optional<WebSocketUpgrade> upgrade; ///< when it asks for one
    std::string peer;                        ///< the address it came from, without a port
    bool is_secure = false;                  ///< it came over TLS
};

} // namespace scanloom::http

#pragma once

#include "common/error/error.hpp"
#include "common/net/connect.hpp"

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace scanloom {

/// How a program connects to a server's robot port.
struct LinkOptions {
    std::vector<net::Address> servers{{"127.0.0.1", "7447"}}; ///< one, or several that share a store
    std::string token_file;                                   ///< empty: no token
    bool tls = false;
    std::string tls_ca_file;   ///< enables tls; empty: the system's certificates
    std::string tls_cert_file; ///< the client's certificate, enables tls; empty: none
    std::string tls_key_file;
};

/// Adds --server, --token-file and the options for TLS, which set `options`.
/// @param token_help  the help text of --token-file
void add_link_options(CLI::App& app, LinkOptions& options, const std::string& token_help);

/// Loads the certificates of the options.
/// @param encrypted  whether the link is encrypted
/// @return the context; null if the link is not encrypted
/// Errors: those of net::client_tls().
[[nodiscard]] Result<net::TlsContext> tls_of(const LinkOptions& options, bool encrypted);

} // namespace scanloom

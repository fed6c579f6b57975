#pragma once

#include "common/error/error.hpp"
#include "server/app/options.hpp"
#include "server/http/context.hpp"
#include "server/store/shared_sessions.hpp"

#include <string>
#include <vector>

/// How a server appears to the others that share its database.
namespace scanloom::app {

/// Returns the server's name: that of --node, else that of the machine and the port for robots.
[[nodiscard]] std::string node_name(const ServerOptions& options);

/// Returns where the server is reached, and its version. A server that listens on all addresses is reached by the
/// machine's name.
/// @param robot_port, http_port  on which it listens
[[nodiscard]] store::NodeInfo node_info(const ServerOptions& options, unsigned robot_port, unsigned http_port);

/// Enters a server's addresses for those with which it shares the log, if there are any.
void enter(store::ScanLog& log, const store::NodeInfo& info);

/// Returns the names and addresses of the other servers that live, for the log; empty: there are none.
[[nodiscard]] std::string others_in(const std::vector<store::Node>& nodes);

/// Returns what the server needs to pass requests on to the others. Their certificates must be valid for the system, or
/// for the file that SSL_CERT_FILE names.
/// Errors: those of net::client_tls().
[[nodiscard]] Result<http::NodeLinks> node_links(store::ScanLog& log);

} // namespace scanloom::app

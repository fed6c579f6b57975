#pragma once

#include "common/net/tls.hpp"
#include "robot_client/uplink/server_address.hpp"

#include <string>

namespace scanloom::load {

/// Address and credentials for the server's HTTP port.
struct HttpPlace {
    robot::ServerAddress server;
    net::TlsContext tls; ///< null: without TLS
    std::string token;   ///< empty: none
};

} // namespace scanloom::load

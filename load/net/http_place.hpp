#pragma once

#include "common/net/tls.hpp"
#include "robot_client/uplink/server_address.hpp"

#include <string>

namespace scanloom::load {

/// Where the server is asked over HTTP, and as whom.
struct HttpPlace {
    robot::ServerAddress server;
    net::TlsContext tls; ///< null: plainly
    std::string token;   ///< empty: none
};

} // namespace scanloom::load

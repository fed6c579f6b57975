#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

struct ServerAddress {
    std::string host; ///< host name or address, without brackets
    std::string port;
};

/// Parses HOST:PORT or [ADDRESS]:PORT with a port from 1 to 65535; returns nullopt for anything else.
[[nodiscard]] std::optional<ServerAddress> parse_server_address(std::string_view text);

} // namespace scanloom::robot

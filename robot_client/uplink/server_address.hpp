#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace scanloom::robot {

struct ServerAddress {
    std::string host; ///< a name or an address, without brackets
    std::string port;
};

/// HOST:PORT or [ADDRESS]:PORT, the port 1 to 65535; nothing for anything else.
[[nodiscard]] std::optional<ServerAddress> parse_server_address(std::string_view text);

} // namespace scanloom::robot

#pragma once

#include <optional>
#include <string>

namespace scanloom::robot {

struct HostPort {
    std::string host; ///< without brackets
    std::string port; ///< 1..65535
};

/// HOST:PORT or [ADDRESS]:PORT.
[[nodiscard]] std::optional<HostPort> split_host_port(const std::string& text);

} // namespace scanloom::robot

#include "robot_client/uplink/server_address.hpp"

#include "common/text/parse_number.hpp"

#include <cstdint>

namespace scanloom::robot {

std::optional<ServerAddress> parse_server_address(std::string_view text) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos) return std::nullopt;
    std::string_view host = text.substr(0, colon);
    const std::string_view port = text.substr(colon + 1);
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
        host = host.substr(1, host.size() - 2);
    } else if (host.find(':') != std::string_view::npos) {
        return std::nullopt; // an IPv6 address without brackets is ambiguous
    }
    if (host.empty() || parse_number<std::uint16_t>(port).value_or(0) == 0) return std::nullopt;
    return ServerAddress{std::string(host), std::string(port)};
}

} // namespace scanloom::robot

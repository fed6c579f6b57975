#include "robot_client/uplink/server_address.hpp"

#include <charconv>
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
    std::uint16_t number = 0;
    const auto [stopped, failed] = std::from_chars(port.data(), port.data() + port.size(), number);
    if (host.empty() || failed != std::errc{} || stopped != port.data() + port.size() || number == 0)
        return std::nullopt;
    return ServerAddress{std::string(host), std::string(port)};
}

} // namespace scanloom::robot

#include "robot_client/app/host_port.hpp"

#include <charconv>

namespace scanloom::robot {
namespace {

bool is_port(const std::string& text) {
    int port = 0;
    const char* end = text.data() + text.size();
    const auto [stopped, failed] = std::from_chars(text.data(), end, port);
    return failed == std::errc{} && stopped == end && port >= 1 && port <= 65535;
}

} // namespace

std::optional<HostPort> split_host_port(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos) return std::nullopt;
    HostPort parts{text.substr(0, colon), text.substr(colon + 1)};
    std::string& host = parts.host;
    if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
        host = host.substr(1, host.size() - 2);
    } else if (host.find(':') != std::string::npos) {
        return std::nullopt; // an IPv6 address without brackets: which colon is the port's?
    }
    if (host.empty() || !is_port(parts.port)) return std::nullopt;
    return parts;
}

} // namespace scanloom::robot

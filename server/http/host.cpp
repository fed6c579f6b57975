#include "server/http/host.hpp"

#include <boost/url/grammar/ci_string.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>

#include <algorithm>

namespace scanloom::http {

bool is_known_host(std::string_view host_field, const std::vector<std::string>& names) {
    const auto authority = boost::urls::parse_authority(host_field);
    if (!authority || authority->has_userinfo()) return false;
    if (authority->host_type() != boost::urls::host_type::name) {
        return authority->host_type() != boost::urls::host_type::none;
    }
    const std::string host = authority->host();
    return boost::urls::grammar::ci_is_equal(host, "localhost") ||
           std::ranges::any_of(names, [&](const auto& name) { return boost::urls::grammar::ci_is_equal(host, name); });
}

namespace {

/// Returns the port of an authority, or the scheme's port if it has none.
std::string_view port_of(const boost::urls::authority_view& authority, std::string_view scheme) {
    if (authority.has_port() && !authority.port().empty()) return authority.port();
    return scheme == "https" ? "443" : "80";
}

} // namespace

bool is_own_page(std::string_view origin, std::string_view host_field, bool is_secure) {
    const auto colon = origin.find("://");
    if (colon == std::string_view::npos) return false; // "null"
    const auto scheme = origin.substr(0, colon);
    if (scheme != "http" && scheme != "https") return false;
    const auto page = boost::urls::parse_authority(origin.substr(colon + 3));
    const auto host = boost::urls::parse_authority(host_field);
    if (!page || !host || page->has_userinfo() || page->host_type() == boost::urls::host_type::none) return false;
    return (scheme == "https" || !is_secure) && boost::urls::grammar::ci_is_equal(page->host(), host->host()) &&
           port_of(*page, scheme) == port_of(*host, scheme);
}

bool is_websocket_key(std::string_view key) noexcept {
    constexpr std::size_t kSize = 24;
    if (key.size() != kSize || !key.ends_with("==")) return false;
    return std::ranges::all_of(key.substr(0, kSize - 2), [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '/';
    });
}

std::string websocket_sources(std::string_view host_field, bool is_secure) {
    const bool is_plain = !host_field.empty() && std::ranges::all_of(host_field, [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
               c == ':';
    });
    const std::string host(host_field);
    if (!is_plain) return {};
    return is_secure ? "wss://" + host : "ws://" + host + " wss://" + host;
}

} // namespace scanloom::http

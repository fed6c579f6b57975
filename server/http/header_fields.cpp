#include "server/http/header_fields.hpp"

#include <boost/url/grammar/ci_string.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

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

std::optional<std::string_view> bearer_of(std::string_view authorization) noexcept {
    constexpr std::string_view kScheme = "Bearer ";
    if (!boost::urls::grammar::ci_is_equal(authorization.substr(0, kScheme.size()), kScheme)) return std::nullopt;
    authorization.remove_prefix(kScheme.size());
    const auto begin = authorization.find_first_not_of(' ');
    if (begin == std::string_view::npos) return std::nullopt;
    return authorization.substr(begin, authorization.find_last_not_of(' ') + 1 - begin);
}

std::optional<std::string_view> cookie_of(std::string_view cookie_field, std::string_view name) noexcept {
    while (!cookie_field.empty()) {
        const auto end = cookie_field.find(';');
        auto pair = cookie_field.substr(0, end);
        cookie_field = end == std::string_view::npos ? std::string_view() : cookie_field.substr(end + 1);
        pair.remove_prefix(std::min(pair.find_first_not_of(" \t"), pair.size()));
        if (pair.starts_with(name) && pair.substr(name.size()).starts_with('=')) return pair.substr(name.size() + 1);
    }
    return std::nullopt;
}

std::string set_login_cookie(std::string_view value, bool is_secure) {
    return fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}{}", kLoginCookie, value, is_secure ? "; Secure" : "",
                       value.empty() ? "; Max-Age=0" : "");
}

namespace {

void skip(std::string_view& text, std::string_view characters) {
    text.remove_prefix(std::min(text.find_first_not_of(characters), text.size()));
}

/// Removes one entity tag from the front and returns it without its W/; empty if there is none.
std::string_view take_tag(std::string_view& text) {
    if (text.starts_with("W/")) text.remove_prefix(2);
    if (!text.starts_with('"')) return {};
    const auto close = text.find('"', 1);
    if (close == std::string_view::npos) return {};
    const auto tag = text.substr(0, close + 1);
    text.remove_prefix(tag.size());
    return tag;
}

} // namespace

bool if_none_match_has(std::string_view field, std::string_view etag) {
    constexpr std::string_view kBlank = " \t";
    skip(field, kBlank);
    if (field.starts_with('*')) return field.find_first_not_of(" \t", 1) == std::string_view::npos;
    bool found = false;
    while (!field.empty()) {
        const auto tag = take_tag(field);
        if (tag.empty()) return false;
        found = found || tag == etag;
        skip(field, kBlank);
        if (!field.empty() && !field.starts_with(',')) return false;
        skip(field, ", \t"); // lists may contain empty elements
    }
    return found;
}

} // namespace scanloom::http

#include "server/http/credentials.hpp"

#include <boost/url/grammar/ci_string.hpp>
#include <fmt/format.h>

namespace scanloom::http {

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

} // namespace scanloom::http

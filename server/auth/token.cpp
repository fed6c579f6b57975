#include "server/auth/token.hpp"

#include "common/scan/limits.hpp"

#include <algorithm>
#include <cstddef>

namespace scanloom::auth {

bool is_valid_pattern(std::string_view pattern) noexcept {
    if (pattern.empty() || pattern.size() > kNameBytesMax) return false;
    return std::ranges::all_of(
        pattern, [](const char& c) { return c == '*' || c == '?' || is_valid_name(std::string_view(&c, 1)); });
}

bool matches(std::string_view pattern, std::string_view name) noexcept {
    constexpr auto kNone = std::string_view::npos;
    std::size_t at = 0;       // in the pattern
    std::size_t star = kNone; // the last '*' passed
    std::size_t tried = 0;    // where the text after that '*' was last assumed to begin
    for (std::size_t i = 0; i < name.size();) {
        if (at < pattern.size() && pattern[at] == '*') {
            star = at++;
            tried = i;
        } else if (at < pattern.size() && (pattern[at] == '?' || pattern[at] == name[i])) {
            ++at;
            ++i;
        } else if (star != kNone) { // the last '*' takes one more character; an earlier '*' never has to
            at = star + 1;
            i = ++tried;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', at) == kNone;
}

bool is_for(const Token& token, std::string_view session) noexcept {
    return std::ranges::any_of(token.sessions, [&](const auto& pattern) { return matches(pattern, session); });
}

bool is_for_all(const Token& token) noexcept {
    return std::ranges::any_of(token.sessions, [](const auto& pattern) { return pattern == "*"; });
}

const TokenRef& default_token() {
    static const TokenRef token = std::make_shared<const Token>(Token{"", "", Role::kOperator, {"*"}, no_limits()});
    return token;
}

} // namespace scanloom::auth

#include "server/access/token.hpp"

#include "server/access/pattern.hpp"

#include <algorithm>

namespace scanloom::access {

bool is_for(const Token& token, std::string_view session) noexcept {
    return std::ranges::any_of(token.sessions, [&](const auto& pattern) { return matches(pattern, session); });
}

bool is_for_all(const Token& token) noexcept {
    return std::ranges::any_of(token.sessions, [](const auto& pattern) { return pattern == "*"; });
}

const TokenRef& anybody() {
    static const TokenRef token = std::make_shared<const Token>(Token{"", "", Role::kOperator, {"*"}, no_limits()});
    return token;
}

} // namespace scanloom::access

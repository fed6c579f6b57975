#include "server/http/text.hpp"

namespace scanloom::http {

std::string in_quotes(std::string_view text) {
    constexpr std::size_t kShown = 64;
    std::string result = "\"";
    for (const char c : text.substr(0, kShown)) result += (c >= ' ' && c <= '~') ? c : '?';
    result += text.size() > kShown ? "...\"" : "\"";
    return result;
}

} // namespace scanloom::http

#include "robot_client/source/tokens.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

namespace scanloom::robot {

Tokens split(std::string_view line) {
    constexpr std::string_view kBlanks = " \t\r\v\f";
    Tokens tokens;
    for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
        tokens.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(kBlanks, end);
    }
    return tokens;
}

std::optional<double> to_number(std::string_view token) {
    double value = 0.0;
    const auto [end, failed] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (end != token.data() + token.size()) return std::nullopt;
    if (failed == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
    if (failed != std::errc{}) return std::nullopt;
    return value;
}

std::string shown_token(std::string_view token) {
    constexpr std::size_t kShownMax = 24;
    std::string text(token.substr(0, kShownMax));
    for (char& c : text) {
        if (c < ' ' || c > '~') c = '?';
    }
    return token.size() > kShownMax ? text + "..." : text;
}

} // namespace scanloom::robot

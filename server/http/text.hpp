#pragma once

#include "common/text/parse_number.hpp"

#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace scanloom::http {

/// Parses an integer in decimal digits with at most one leading minus sign. Returns nullopt if it does not fit into T.
template <std::integral T>
[[nodiscard]] std::optional<T> parse_integer(std::string_view text) {
    return parse_number<T>(text);
}

/// Parses a finite number in the notation of JSON.
[[nodiscard]] inline std::optional<double> parse_real(std::string_view text) {
    const auto value = parse_number<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Rounds metres for output to a micrometre: -19.95 instead of -19.950000000000003, the product of a cell count and the
/// cell size.
[[nodiscard]] inline double rounded_metres(double metres) {
    constexpr double kPerMetre = 1e6;
    const double rounded = std::round(metres * kPerMetre) / kPerMetre;
    return std::isfinite(rounded) ? rounded : metres;
}

/// Quotes untrusted text for a message or a log line: at most 64 characters, with '?' for everything but printable
/// ASCII.
[[nodiscard]] inline std::string in_quotes(std::string_view text) {
    constexpr std::size_t kShown = 64;
    std::string result = "\"";
    for (const char c : text.substr(0, kShown)) result += (c >= ' ' && c <= '~') ? c : '?';
    result += text.size() > kShown ? "...\"" : "\"";
    return result;
}

} // namespace scanloom::http

#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace scanloom::http {

/// Parses an integer in decimal digits with at most one leading minus sign. Returns nullopt if it does not fit into T.
template <std::integral T>
[[nodiscard]] std::optional<T> parse_integer(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// Parses a finite number in the notation of JSON.
[[nodiscard]] inline std::optional<double> parse_real(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
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
[[nodiscard]] std::string in_quotes(std::string_view text);

} // namespace scanloom::http

#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <string_view>
#include <system_error>

namespace scanloom::http {

/// A whole number in decimal digits, one minus sign before it at most; nothing also when it does not fit.
template <std::integral T>
[[nodiscard]] std::optional<T> parse_integer(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// A finite number, as JSON writes them.
[[nodiscard]] inline std::optional<double> parse_real(std::string_view text) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

/// Metres to be shown, without the noise of the last bits: -19.95 where a product of cells and their size has
/// -19.950000000000003. Exact to a micrometre.
[[nodiscard]] inline double rounded_metres(double metres) {
    constexpr double kPerMetre = 1e6;
    const double rounded = std::round(metres * kPerMetre) / kPerMetre;
    return std::isfinite(rounded) ? rounded : metres;
}

} // namespace scanloom::http

#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

namespace scanloom::http {

/// A whole number in decimal digits, one minus sign before it at most. What does not fit is clamped to the
/// nearest that does: too large is a matter of range, not of form.
template <std::integral T>
[[nodiscard]] std::optional<T> parse_integer(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end != text.data() + text.size() || error == std::errc::invalid_argument) return std::nullopt;
    if (error != std::errc::result_out_of_range) return value;
    return text.front() == '-' ? std::numeric_limits<T>::min() : std::numeric_limits<T>::max();
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

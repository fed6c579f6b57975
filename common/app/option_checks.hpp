#pragma once

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

/// What numbers options take, as CLI::Option::check() wants it: nothing where the text is right, else what is wrong.
/// Only option parsers include this header.
namespace scanloom {

/// CLI::Range lets NaN pass.
[[nodiscard]] inline auto check_within(double low, double high) {
    return [=](const std::string& text) {
        double value = 0.0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
        return fmt::format("'{}' is not within {:g} to {:g}", text, low, high);
    };
}

/// The same without the lower end.
[[nodiscard]] inline auto check_above_up_to(double low, double high) {
    return [=](const std::string& text) {
        double value = 0.0;
        if (CLI::detail::lexical_cast(text, value) && value > low && value <= high) return std::string();
        return fmt::format("'{}' is not more than {:g} and at most {:g}", text, low, high);
    };
}

[[nodiscard]] inline std::string check_positive(const std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0.0) return {};
    return fmt::format("'{}' is not more than 0", text);
}

[[nodiscard]] inline std::string check_not_negative(const std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value >= 0.0) return {};
    return fmt::format("'{}' is not 0 or more", text);
}

/// CLI11 by itself would take -1 for the largest number.
[[nodiscard]] inline auto check_whole_number_from(std::uint64_t low) {
    return [=](const std::string& text) {
        std::uint64_t value = 0;
        const char* end = text.data() + text.size();
        const auto [stopped, error] = std::from_chars(text.data(), end, value);
        if (error == std::errc{} && stopped == end && value >= low) return std::string();
        return fmt::format("'{}' is not a whole number from {} to {}", text, low,
                           std::numeric_limits<std::uint64_t>::max());
    };
}

} // namespace scanloom

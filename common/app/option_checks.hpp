#pragma once

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

/// Checks of numbers for CLI::Option::check(): each returns an empty string if the text is valid, else what is wrong.
/// Only option parsers include this header.
namespace scanloom {

/// Accepts numbers from `low` to `high`. Rejects NaN, which CLI::Range accepts.
[[nodiscard]] inline auto check_within(double low, double high) {
    return [=](const std::string& text) {
        double value = 0.0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return std::string();
        return fmt::format("'{}' is not within {:g} to {:g}", text, low, high);
    };
}

/// Accepts numbers above `low` and up to `high`.
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

/// Accepts whole numbers from `low` on. Rejects -1, which CLI11 alone converts to the largest number.
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

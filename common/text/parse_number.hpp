#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace scanloom {

/// Parses a text that is a number as a whole, independently of the locale: without blanks and without a plus sign.
/// @return nullopt if the text is not a number, or if the number does not fit into T
template <class T>
[[nodiscard]] std::optional<T> parse_number(std::string_view text) {
    T number{};
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || stopped != end) return std::nullopt;
    return number;
}

} // namespace scanloom

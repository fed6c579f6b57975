#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The words and numbers of text recordings.
namespace scanloom::robot {

using Tokens = std::vector<std::string_view>;

/// Splits a line at blanks.
[[nodiscard]] Tokens split(std::string_view line);

/// Converts a whole token to a number; one too large for a double becomes infinite.
[[nodiscard]] std::optional<double> to_number(std::string_view token);

/// Returns a token for messages: shortened, and without characters that a terminal could interpret.
[[nodiscard]] std::string shown_token(std::string_view token);

} // namespace scanloom::robot

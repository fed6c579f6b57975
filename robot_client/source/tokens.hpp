#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The words and numbers of recordings in text.
namespace scanloom::robot {

using Tokens = std::vector<std::string_view>;

/// What blanks divide.
[[nodiscard]] Tokens split(std::string_view line);

/// A whole token as a number; one too large for a double counts as infinite.
[[nodiscard]] std::optional<double> to_number(std::string_view token);

/// A token for people: short, and without what a terminal could take for a command.
[[nodiscard]] std::string shown_token(std::string_view token);

} // namespace scanloom::robot

#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <iosfwd>
#include <string>
#include <string_view>

namespace scanloom {

/// A TOML file as CLI11 reads it without mistakes: no comments, every array on one line. By itself CLI11 takes what is
/// not closed for closed, lines after an array for a part of it, and a '#' within a string for a comment.
///
/// Errors  kMalformed: a string or an array that is not closed, or with something behind it; the message begins with
///         the number of the line.
[[nodiscard]] Result<std::string> one_line_a_setting(std::string_view toml);

/// What a file of settings may have at most: who names a device or a log by mistake is told so.
inline constexpr std::size_t kConfigBytesMax = std::size_t{1} << 20;

/// All that there is to be read.
/// Errors  kFull: it is more than kConfigBytesMax.
[[nodiscard]] Result<std::string> read_config_text(std::istream& input);

} // namespace scanloom

#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <iosfwd>
#include <string>
#include <string_view>

namespace scanloom {

/// Rewrites a TOML file so that CLI11 reads it correctly: without comments and with every array on one line.
///
/// CLI11 alone accepts strings and arrays that are not closed, takes the lines after an array for a part of it, and
/// takes a '#' in a string for the start of a comment.
///
/// Errors: kMalformed if a string or an array is not closed, or is not followed by a separator; the message begins with
///         the line number.
[[nodiscard]] Result<std::string> one_line_a_setting(std::string_view toml);

/// The largest settings file, in bytes. A device or a log that is named by mistake gives an error.
inline constexpr std::size_t kConfigBytesMax = std::size_t{1} << 20;

/// Reads `input` to its end.
/// Errors: kFull if it has more than kConfigBytesMax bytes.
[[nodiscard]] Result<std::string> read_config_text(std::istream& input);

} // namespace scanloom

#pragma once

#include "common/error/error.hpp"

#include <cstddef>
#include <iosfwd>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace scanloom {

/// Makes `app` read settings from the environment and from the file of --config. A flag overrides the environment,
/// which overrides the file. The variable of --cell-size is SCANLOOM_CELL_SIZE.
///
/// Call it after all options and subcommands are added. app.parse() then rejects unknown settings in the file and empty
/// values.
/// Errors: throws CLI::ParseError if SCANLOOM_CONFIG names a missing file or a setting in the environment is empty.
void read_settings_from_environment_and_file(CLI::App& app);

/// Rejects an empty value, for CLI::Option::check(): a script's variable that was never set must not disable a setting.
/// @return an empty string if the value is valid, else what is wrong
[[nodiscard]] std::string check_not_empty(const std::string& text);

/// Rewrites a TOML file so that CLI11 reads it correctly: without comments and with every array on one line.
///
/// CLI11 alone accepts strings and arrays that are not closed, takes the lines after an array for a part of it, and
/// takes a '#' in a string for the start of a comment. toml++ is not used here: in Debian's version 3.3, letters beyond
/// ASCII, which paths may have, lead to undefined behaviour (its issues 190 and 295).
///
/// Errors: kMalformed if a string or an array is not closed, or is not followed by a separator; the message begins with
///         the line number.
[[nodiscard]] Result<std::string> one_line_a_setting(std::string_view toml);

/// The largest settings file, in bytes. A device or a log that is named by mistake gives an error.
inline constexpr std::size_t kConfigBytesMax = std::size_t{1} << 20;

/// Reads `input` to its end.
/// Errors: kFull if it has more than kConfigBytesMax bytes.
[[nodiscard]] Result<std::string> read_config_text(std::istream& input);

/// Reads the first line of a token file; returns an empty string if `path` is empty.
/// Errors: kNotFound if the file cannot be read or its first line is empty.
[[nodiscard]] Result<std::string> read_token(const std::string& path);

} // namespace scanloom

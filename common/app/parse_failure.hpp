#pragma once

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string>
#include <string_view>

/// Only option parsers include this header.
namespace scanloom {

/// Why CLI11 refused flags, environment or file: one line, in words that a person who never heard of CLI11 understands.
[[nodiscard]] inline std::string sentence_of(const CLI::ParseError& reason) {
    std::string what = reason.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    constexpr std::string_view kUnknown = "INI was not able to parse ";
    constexpr std::string_view kMissing = " was not readable (missing?)";
    if (what.starts_with(kUnknown)) {
        return "the file of --config has a setting that is not known: " + what.substr(kUnknown.size());
    }
    if (what.ends_with(kMissing)) {
        return "the file of --config cannot be read: " + what.substr(0, what.size() - kMissing.size());
    }
    return what;
}

} // namespace scanloom

#pragma once

#include "common/app/program.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

/// Only option parsers include this header.
namespace scanloom {

/// Explains in one line, without CLI11's own terms, why CLI11 rejected the flags, the environment or the file.
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

/// Returns how a program ends after a usage error; the text refers to --help.
[[nodiscard]] inline Leave usage_error(const CLI::App& app, std::string_view what) {
    return {kExitUsage, fmt::format("{0}: {1}; see {0} --help\n", app.get_name(), what)};
}

/// Returns how a program ends after CLI11 has thrown, which it also does when help or the version is requested.
/// @param app       the parser that has thrown
/// @param reason    what it has thrown
/// @param commands  error text for a command line that names no subcommand
/// @return exit code and output
[[nodiscard]] inline Leave leave_for(const CLI::App& app, const CLI::ParseError& reason,
                                     std::string_view commands = "") {
    if (reason.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
        const bool is_help = reason.get_name() == "CallForHelp" || reason.get_name() == "CallForAllHelp";
        return {kExitDone, is_help ? app.help() : std::string(reason.what()) + "\n"};
    }
    const std::string what = sentence_of(reason);
    return usage_error(app, what == "A subcommand is required" ? commands : what);
}

} // namespace scanloom

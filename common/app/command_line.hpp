#pragma once

#include "common/app/program.hpp"
#include "common/error/error.hpp"
#include "common/scan/limits.hpp"
#include "common/text/parse_number.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

/// Functions that all option parsers use: they end a program after a usage error, and check numbers for
/// CLI::Option::check(). A check returns an empty string if the text is valid, otherwise the error. Only option parsers
/// include this header.
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

/// Adds an option whose text is parsed.
/// @param into   receives the value; must outlive the parsing
/// @param parse  returns a Result; the message of an error is shown after the option's name
template <class Value, class Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& name, Value& into, const std::string& help, Parse parse) {
    const auto check = [parse](const std::string& text) {
        const auto value = parse(text);
        return value ? std::string() : value.error().message;
    };
    const auto assign = [&into, parse](const std::string& text) { into = parse(text).value(); };
    return app.add_option_function<std::string>(name, assign, help)->check(check);
}

/// Adds an option whose values are checked and whose default is in the output of --help.
/// @param check  for CLI::Option::check()
template <class Value, class Check>
CLI::Option* add_checked(CLI::App& app, const std::string& name, Value& into, const std::string& help, Check check) {
    return app.add_option(name, into, help)->check(std::move(check))->capture_default_str();
}

/// Accepts numbers for which `is_valid` holds. Never accepts NaN, which CLI::Range accepts.
/// @param what  the end of the error text "'TEXT' is not ..."
template <class Predicate>
[[nodiscard]] auto check_number(std::string what, Predicate is_valid) {
    return [=](const std::string& text) {
        double value = 0.0;
        if (CLI::detail::lexical_cast(text, value) && !std::isnan(value) && is_valid(value)) return std::string();
        return fmt::format("'{}' is not {}", text, what);
    };
}

[[nodiscard]] inline auto check_within(double low, double high) {
    return check_number(fmt::format("within {:g} to {:g}", low, high),
                        [=](double value) { return value >= low && value <= high; });
}

[[nodiscard]] inline auto check_above_up_to(double low, double high) {
    return check_number(fmt::format("more than {:g} and at most {:g}", low, high),
                        [=](double value) { return value > low && value <= high; });
}

/// Accepts names of sessions, robots and tokens.
[[nodiscard]] inline std::string check_name(const std::string& name) {
    if (is_valid_name(name)) return {};
    return fmt::format("'{}' is not a name; use 1 to {} characters of A-Z a-z 0-9 _ -", name, kNameBytesMax);
}

[[nodiscard]] inline std::string check_positive(const std::string& text) {
    return check_number("more than 0", [](double value) { return std::isfinite(value) && value > 0.0; })(text);
}

[[nodiscard]] inline std::string check_not_negative(const std::string& text) {
    return check_number("0 or more", [](double value) { return std::isfinite(value) && value >= 0.0; })(text);
}

/// Accepts whole numbers from `low` on. Rejects -1, which CLI11 alone converts to the largest number.
[[nodiscard]] inline auto check_whole_number_from(std::uint64_t low) {
    return [=](const std::string& text) {
        if (const auto value = parse_number<std::uint64_t>(text); value && *value >= low) return std::string();
        return fmt::format("'{}' is not a whole number from {} to {}", text, low,
                           std::numeric_limits<std::uint64_t>::max());
    };
}

} // namespace scanloom

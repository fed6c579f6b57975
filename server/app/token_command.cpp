#include "server/app/token_command.hpp"

#include "common/app/command_line.hpp"
#include "common/scan/limits.hpp"
#include "server/auth/token.hpp"
#include "server/auth/token_text.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <string>
#include <string_view>

namespace scanloom::app {
namespace {

constexpr const char* kAboutToken =
    "Creates a token: prints its secret, once, and the lines to add to the file of --tokens.\n"
    "A client that sends the secret gets the permissions of the token; the file contains only its hash.";

std::string check_pattern(const std::string& pattern) {
    if (auth::is_valid_pattern(pattern)) return {};
    return fmt::format("'{}' is not a pattern of sessions; use 1 to {} characters of A-Z a-z 0-9 _ - * ?", pattern,
                       kNameBytesMax);
}

std::string report(const auth::Token& token, std::string_view secret) {
    return fmt::format(
        "{}\n\n"
        "# This is the secret: give it to the client, it is not shown again. A robot reads it from the file "
        "of --token-file.\n"
        "# Add these lines to the file of --tokens; SIGHUP makes the server read it again.\n{}",
        secret, text_of(token));
}

} // namespace

std::optional<Leave> token_command(int argc, const char* const* argv) {
    if (argc < 2 || std::string_view(argv[1]) != "token") return std::nullopt;
    auth::Token token;
    std::string role;
    CLI::App app(kAboutToken, "scanloom-server token");
    app.add_option("--name", token.name, "Name of the token in the file and in logs")->required()->check(check_name);
    app.add_option("--role", role, "robot: sends scans; viewer: reads; operator: everything, also creates and deletes")
        ->required()
        ->check(CLI::IsMember({"robot", "viewer", "operator"}));
    app.add_option("--session", token.sessions,
                   "Patterns of the sessions it is valid for: * matches any text, ? one character [*]")
        ->check(check_pattern);
    try {
        app.parse(argc - 1, argv + 1);
    } catch (const CLI::ParseError& reason) {
        return leave_for(app, reason);
    }
    token.role = *auth::role_of(role);
    if (token.sessions.empty()) token.sessions = {"*"};
    const auto secret = auth::random_secret();
    token.hash = auth::hash_of(secret);
    return Leave{kExitDone, report(token, secret)};
}

} // namespace scanloom::app

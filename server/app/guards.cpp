#include "server/app/guards.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <array>

namespace scanloom::app {
namespace {

/// A port, and what protects it.
struct Guard {
    const char* flag;
    const boost::asio::ip::tcp::endpoint& endpoint;
    bool has_tokens;
    const sockets::TlsFiles& tls;
    const char* remedy; ///< the settings that would protect it, for a message

    [[nodiscard]] bool is_reached() const { return !endpoint.address().is_loopback(); }
};

std::array<Guard, 2> guards_of(const ServerOptions& options) {
    const bool has_tokens = !options.tokens.empty();
    return {{{"--listen", options.listen, has_tokens, options.robot_tls, "add --tokens or --robot-tls-cert"},
             {"--http", options.http, has_tokens, options.http_tls, "add --tokens or --http-tls-cert"}}};
}

} // namespace

Result<> check_guarded(const ServerOptions& options) {
    if (options.insecure) return {};
    for (const auto& guard : guards_of(options)) {
        if (!guard.is_reached() || guard.has_tokens || guard.tls.is_given()) continue;
        return Error{
            Errc::kInvalidField,
            fmt::format(
                "{} {} can be reached from other machines without tokens or TLS; {}; or listen on 127.0.0.1, or "
                "add --insecure if all of them may send and read",
                guard.flag, guard.endpoint.address().to_string(), guard.remedy)};
    }
    return {};
}

std::vector<std::string> guard_warnings(const ServerOptions& options) {
    std::vector<std::string> warnings;
    for (const auto& guard : guards_of(options)) {
        if (!guard.is_reached()) continue;
        if (!guard.tls.is_given() && guard.has_tokens) {
            warnings.push_back(
                fmt::format("{}: clients send tokens without TLS; everyone on the network path can read and "
                            "use them, and read all other data",
                            guard.flag));
        } else if (!guard.has_tokens) {
            const bool is_mutual = !guard.tls.client_ca.empty();
            warnings.push_back(fmt::format(
                "{}: no token is required; every client that {} can send and read everything{}", guard.flag,
                is_mutual ? "presents a certificate signed by " + guard.tls.client_ca.string() : "reaches it",
                guard.tls.is_given() ? "; others on the network path cannot" : ""));
        }
    }
    return warnings;
}

} // namespace scanloom::app

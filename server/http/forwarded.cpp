#include "server/http/forwarded.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>

namespace scanloom::http {

std::string forwarded_text(const ForwardedFor& client, std::string_view secret) {
    return fmt::format("{} {} {}", secret, client.is_secure ? "https" : "http", client.peer);
}

std::optional<ForwardedFor> parse_forwarded(std::string_view value, std::string_view secret) {
    const bool is_ours = !secret.empty() && value.size() > secret.size() && value[secret.size()] == ' ' &&
                         CRYPTO_memcmp(value.data(), secret.data(), secret.size()) == 0;
    if (!is_ours) return std::nullopt;
    value.remove_prefix(secret.size() + 1);
    const auto space = value.find(' ');
    if (space == std::string_view::npos) return std::nullopt;
    return ForwardedFor{std::string(value.substr(space + 1)), value.substr(0, space) == "https"};
}

} // namespace scanloom::http

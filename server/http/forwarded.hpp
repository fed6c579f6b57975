#pragma once

#include <optional>
#include <string>
#include <string_view>

/// The field with which a server passes a request on to another one that shares its database.
namespace scanloom::http {

/// The field of such a request. It begins with the secret that only the servers know, so that others cannot send it.
inline constexpr std::string_view kForwardedField = "Scanloom-Forwarded";

/// The client that sent a request to the first server.
struct ForwardedFor {
    std::string peer;       ///< its address, without a port
    bool is_secure = false; ///< it used TLS

    friend bool operator==(const ForwardedFor&, const ForwardedFor&) = default;
};

/// Returns the value of the field.
[[nodiscard]] std::string forwarded_text(const ForwardedFor& client, std::string_view secret);

/// Reads the value of the field.
/// @param secret  of this server; empty: it shares its store with no other
/// @return nullopt if the value was not written with this secret
[[nodiscard]] std::optional<ForwardedFor> parse_forwarded(std::string_view value, std::string_view secret);

} // namespace scanloom::http

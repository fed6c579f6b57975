#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Cookies of signed-in browsers that every server of a database accepts: they are signed with the servers' secret.
namespace scanloom::auth {

/// Returns a cookie's value: random bits, the hash of the token, the time, and their signature, in that order.
/// @param random      a new secret_of() random bits
/// @param token_hash  of the token that was used to sign in, hash_of()
/// @param now         seconds since 1970, UTC
/// @param secret      of the servers
/// Source: RFC 2104 (HMAC) with SHA-256.
[[nodiscard]] std::string signed_cookie(std::string_view random, std::string_view token_hash, double now,
                                        std::string_view secret);

/// Reads a cookie that signed_cookie() has made with the same secret.
/// @param age_max  largest age, seconds
/// @return the hash of the token; nullopt if the cookie is not valid or too old
[[nodiscard]] std::optional<std::string> token_hash_in(std::string_view cookie, double now, double age_max,
                                                       std::string_view secret);

} // namespace scanloom::auth

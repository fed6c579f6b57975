#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

/// Secrets: the text by which a client proves that it holds a token.
namespace scanloom::auth {

/// Returns "scanloom_" and 64 hexadecimal digits.
///
/// A secret is longer than any valid name, so it cannot be mistaken for a session or robot name. The prefix makes
/// secrets recognizable, so that logs can be cleaned of them and secret scanners find them in repositories.
/// @param random  256 unpredictable bits
[[nodiscard]] std::string secret_of(const std::array<std::byte, 32>& random);

/// Returns the SHA-256 of the secret as 64 lower-case hexadecimal digits. A slow password hash would add no protection,
/// because 256 random bits cannot be guessed from a dictionary.
[[nodiscard]] std::string hash_of(std::string_view secret);

/// Returns whether the text has the form that hash_of() returns.
[[nodiscard]] bool is_hash(std::string_view text) noexcept;

/// Returns the text with every secret, even a truncated one, replaced by "scanloom_...". For logs, because clients may
/// send a secret in a field that is logged.
[[nodiscard]] std::string without_secrets(std::string_view text);

/// Creates a secret from 256 random bits of the system.
/// Errors: std::runtime_error if the system has none.
[[nodiscard]] std::string random_secret();

} // namespace scanloom::auth

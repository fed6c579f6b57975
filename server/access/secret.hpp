#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

/// Secrets: what the holder of a token sends.
namespace scanloom::access {

/// "scanloom_" and 64 hexadecimal digits, of 256 bits that nobody can guess.
///
/// It is longer than any name, so none can pass for a session's or a robot's; and it shows what it is, so that logs can
/// be kept free of it, and those who search repositories for secrets find it.
[[nodiscard]] std::string secret_of(const std::array<std::byte, 32>& random);

/// SHA-256, 64 lower-case digits. A slow hash, as passwords need, would guard nothing more: there is no dictionary of
/// 256 random bits.
[[nodiscard]] std::string hash_of(std::string_view secret);

/// Whether it is what hash_of() returns.
[[nodiscard]] bool is_hash(std::string_view text) noexcept;

/// The text with every secret in it, also one that was cut short, as "scanloom_...". For logs: strangers send secrets
/// where none belongs.
[[nodiscard]] std::string without_secrets(std::string_view text);

} // namespace scanloom::access

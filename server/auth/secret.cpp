#include "server/auth/secret.hpp"

#include "common/hash/sha256.hpp"

#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>

namespace scanloom::auth {
namespace {

constexpr std::string_view kPrefix = "scanloom_";
constexpr std::string_view kLowerDigits = "0123456789abcdef";
constexpr std::string_view kDigits = "0123456789abcdefABCDEF";
constexpr std::size_t kHashDigits = 64;

/// This many digits after the prefix are taken for a secret.
constexpr std::size_t kTellingDigits = 8;

} // namespace

std::string secret_of(const std::array<std::byte, 32>& random) {
    std::string secret(kPrefix);
    for (const std::byte byte : random) {
        secret += kLowerDigits[std::to_integer<std::size_t>(byte >> 4)];
        secret += kLowerDigits[std::to_integer<std::size_t>(byte & std::byte{0xf})];
    }
    return secret;
}

std::string hash_of(std::string_view secret) {
    Sha256 hash;
    hash.update(secret);
    return hash.hex();
}

bool is_hash(std::string_view text) noexcept {
    return text.size() == kHashDigits && text.find_first_not_of(kLowerDigits) == std::string_view::npos;
}

std::string without_secrets(std::string_view text) {
    std::string clean;
    for (;;) {
        const auto found = text.find(kPrefix);
        if (found == std::string_view::npos) return clean.append(text);
        const auto digits = found + kPrefix.size();
        const auto end = std::min(text.find_first_not_of(kDigits, digits), text.size());
        clean.append(text.substr(0, digits));
        clean.append(end - digits >= kTellingDigits ? "..." : text.substr(digits, end - digits));
        text.remove_prefix(end);
    }
}

std::string random_secret() {
    std::array<std::byte, 32> random{};
    if (RAND_bytes(reinterpret_cast<unsigned char*>(random.data()), static_cast<int>(random.size())) != 1)
        throw std::runtime_error("the system gives no random numbers, so no secret can be made");
    return secret_of(random);
}

} // namespace scanloom::auth

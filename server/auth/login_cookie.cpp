#include "server/auth/login_cookie.hpp"

#include "common/text/parse_number.hpp"
#include "server/auth/token.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <array>
#include <cstdint>

namespace scanloom::auth {
namespace {

constexpr double kClockSkewMax = 60.0; // between two servers, seconds

std::string signature_of(std::string_view text, std::string_view secret) {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned size = 0;
    HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
         reinterpret_cast<const unsigned char*>(text.data()), text.size(), bytes.data(), &size);
    std::string hex;
    for (unsigned n = 0; n < size; ++n) hex += fmt::format("{:02x}", bytes[n]);
    return hex;
}

/// Removes the part behind the last dot, and returns it.
std::string_view take_last(std::string_view& text) {
    const auto dot = text.rfind('.');
    if (dot == std::string_view::npos) return {};
    const auto last = text.substr(dot + 1);
    text = text.substr(0, dot);
    return last;
}

} // namespace

std::string signed_cookie(std::string_view random, std::string_view token_hash, double now, std::string_view secret) {
    const auto text = fmt::format("{}.{}.{}", random, token_hash, static_cast<std::int64_t>(now));
    return fmt::format("{}.{}", text, signature_of(text, secret));
}

std::optional<std::string> token_hash_in(std::string_view cookie, double now, double age_max, std::string_view secret) {
    const auto signature = take_last(cookie);
    const auto expected = signature_of(cookie, secret);
    if (signature.size() != expected.size() || CRYPTO_memcmp(signature.data(), expected.data(), expected.size()) != 0) {
        return std::nullopt;
    }
    const auto time = parse_number<std::int64_t>(take_last(cookie));
    const auto hash = take_last(cookie);
    if (!time || !is_hash(hash)) return std::nullopt;
    const double age = now - static_cast<double>(*time);
    if (age < -kClockSkewMax || age > age_max) return std::nullopt;
    return std::string(hash);
}

} // namespace scanloom::auth

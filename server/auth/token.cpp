#include "server/auth/token.hpp"

#include "common/hash/sha256.hpp"
#include "common/scan/limits.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>
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

bool is_valid_pattern(std::string_view pattern) noexcept {
    if (pattern.empty() || pattern.size() > kNameBytesMax) return false;
    return std::ranges::all_of(
        pattern, [](const char& c) { return c == '*' || c == '?' || is_valid_name(std::string_view(&c, 1)); });
}

bool matches(std::string_view pattern, std::string_view name) noexcept {
    constexpr auto kNone = std::string_view::npos;
    std::size_t at = 0;       // in the pattern
    std::size_t star = kNone; // the last '*' passed
    std::size_t tried = 0;    // where the text after that '*' was last assumed to begin
    for (std::size_t i = 0; i < name.size();) {
        if (at < pattern.size() && pattern[at] == '*') {
            star = at++;
            tried = i;
        } else if (at < pattern.size() && (pattern[at] == '?' || pattern[at] == name[i])) {
            ++at;
            ++i;
        } else if (star != kNone) { // the last '*' takes one more character; an earlier '*' never has to
            at = star + 1;
            i = ++tried;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', at) == kNone;
}

bool is_for(const Token& token, std::string_view session) noexcept {
    return std::ranges::any_of(token.sessions, [&](const auto& pattern) { return matches(pattern, session); });
}

bool is_for_all(const Token& token) noexcept {
    return std::ranges::any_of(token.sessions, [](const auto& pattern) { return pattern == "*"; });
}

Admitted<void> check_permission(const Token& token, Action action, std::optional<std::string_view> session) {
    if (!permits(token.role, action)) {
        const auto lack = action == Action::kDrive  ? "sends no scans"
                          : action == Action::kRead ? "does not read maps"
                                                    : "does not permit this";
        return Denied{Reason::kWrongRole, token.name,
                      Error{Errc::kUnauthorized,
                            fmt::format("the token '{}' has the role {}, which {}; use a token of another role",
                                        token.name, name_of(token.role), lack)}};
    }
    if (!session || is_for(token, *session)) return {};
    const auto which = is_valid_name(*session) ? fmt::format("the session '{}'", *session) : "this session";
    return Denied{
        Reason::kWrongSession, token.name,
        Error{Errc::kUnauthorized,
              fmt::format("the token '{}' is not for {}; use another token or another session", token.name, which)}};
}

const TokenRef& default_token() {
    static const TokenRef token = std::make_shared<const Token>(Token{"", "", Role::kOperator, {"*"}, no_limits()});
    return token;
}

TokenRef TokenSet::find(std::string_view secret) const { return find_hash(hash_of(secret)); }

TokenRef TokenSet::find_hash(std::string_view hash) const {
    const Token* found = nullptr;
    std::size_t index = 0;
    for (std::size_t n = 0; n < tokens_.size(); ++n) {
        const Token& token = *tokens_[n];
        const bool same =
            token.hash.size() == hash.size() && CRYPTO_memcmp(token.hash.data(), hash.data(), hash.size()) == 0;
        found = same ? &token : found;
        index = same ? n : index;
    }
    return found == nullptr ? nullptr : tokens_[index];
}

} // namespace scanloom::auth

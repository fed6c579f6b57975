#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct evp_md_ctx_st; // OpenSSL's EVP_MD_CTX

namespace scanloom {

/// Computes the SHA-256 digest of a sequence of byte ranges, with OpenSSL.
/// Errors: std::runtime_error if memory runs out or the OpenSSL installation lacks SHA-256.
/// Source: FIPS 180-4.
class Sha256 {
public:
    Sha256();
    Sha256(const Sha256& other);
    Sha256(Sha256&& other) noexcept = default;
    Sha256& operator=(Sha256 other) noexcept {
        context_.swap(other.context_);
        return *this;
    }
    ~Sha256() = default;

    void update(std::span<const std::byte> bytes);
    void update(std::string_view text) { update(std::as_bytes(std::span(text))); }

    /// Finishes the digest; call it once, last.
    /// @return 64 lower-case hexadecimal digits
    [[nodiscard]] std::string hex();

private:
    struct Free {
        void operator()(evp_md_ctx_st* context) const noexcept;
    };

    std::unique_ptr<evp_md_ctx_st, Free> context_;
};

} // namespace scanloom

#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct evp_md_ctx_st; // OpenSSL's EVP_MD_CTX

namespace scanloom {

/// SHA-256 of bytes that come piece by piece (FIPS 180-4, computed by OpenSSL).
/// Errors  std::runtime_error when memory is short or OpenSSL's installation lacks SHA-256.
class Sha256 {
public:
    Sha256();

    void update(std::span<const std::byte> bytes);
    void update(std::string_view text) { update(std::as_bytes(std::span(text))); }

    /// 64 lower-case digits. Once, at the end.
    [[nodiscard]] std::string hex();

private:
    struct Free {
        void operator()(evp_md_ctx_st* context) const noexcept;
    };

    std::unique_ptr<evp_md_ctx_st, Free> context_;
};

} // namespace scanloom

#pragma once

#include "tests/support/http_client.hpp"
#include "tests/support/test_certificate.hpp"

#include <openssl/err.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

namespace scanloom::testing_support {

/// The settings of a TLS client that uses OpenSSL directly, without the code under test.
struct TlsManner {
    std::filesystem::path trusted;           ///< file of the trusted certificates
    std::optional<CertificateFiles> shown{}; ///< the client's own certificate
    int version_min = TLS1_2_VERSION;
    int version_max = TLS1_3_VERSION;
};

/// An HttpClient over TLS.
class TlsHttpClient final : public HttpClient {
public:
    TlsHttpClient(std::uint16_t port, const TlsManner& manner)
        : HttpClient(port), context_(SSL_CTX_new(TLS_client_method()), SSL_CTX_free) {
        SSL_CTX_set_min_proto_version(context_.get(), manner.version_min);
        SSL_CTX_set_max_proto_version(context_.get(), manner.version_max);
        SSL_CTX_load_verify_locations(context_.get(), manner.trusted.c_str(), nullptr);
        SSL_CTX_set_verify(context_.get(), SSL_VERIFY_PEER, nullptr);
        if (manner.shown) {
            SSL_CTX_use_certificate_chain_file(context_.get(), manner.shown->certificate.c_str());
            SSL_CTX_use_PrivateKey_file(context_.get(), manner.shown->key.c_str(), SSL_FILETYPE_PEM);
        }
        tls_.reset(SSL_new(context_.get()));
        SSL_set_fd(tls_.get(), descriptor());
        is_trusted_ = SSL_connect(tls_.get()) == 1;
    }

    /// Returns whether the handshake succeeded, as far as this side knows.
    [[nodiscard]] bool is_trusted() const noexcept { return is_trusted_; }

    [[nodiscard]] std::string version() const { return SSL_get_version(tls_.get()); }
    [[nodiscard]] std::string cipher() const { return SSL_get_cipher_name(tls_.get()); }
    [[nodiscard]] bool has_ticket() const { return SSL_SESSION_has_ticket(SSL_get_session(tls_.get())) == 1; }

    /// Requests another handshake of TLS 1.2. @return whether the server accepted it
    [[nodiscard]] bool renegotiate() { return SSL_renegotiate(tls_.get()) == 1 && SSL_do_handshake(tls_.get()) == 1; }

    /// Returns whether the server closed the TLS session with a close_notify instead of cutting the connection.
    [[nodiscard]] bool is_taken_leave_of() {
        static_cast<void>(ends_in_order());
        return (SSL_get_shutdown(tls_.get()) & SSL_RECEIVED_SHUTDOWN) != 0;
    }

    /// Returns OpenSSL's error about the connection; empty: none.
    [[nodiscard]] std::string complaint() const { return complaint_; }

protected:
    ssize_t put(std::string_view bytes) override {
        return noted(
            SSL_write(tls_.get(), bytes.data(), static_cast<int>(std::min<std::size_t>(bytes.size(), 1 << 20))));
    }
    ssize_t take(char* into, std::size_t size) override {
        return noted(SSL_read(tls_.get(), into, static_cast<int>(size)));
    }

private:
    int noted(int outcome) {
        if (outcome > 0) return outcome;
        const auto why = SSL_get_error(tls_.get(), outcome);
        if (why == SSL_ERROR_SSL) complaint_ = ERR_reason_error_string(ERR_peek_last_error());
        return why == SSL_ERROR_ZERO_RETURN ? 0 : -1;
    }

    std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_;
    std::unique_ptr<SSL, decltype(&SSL_free)> tls_{nullptr, SSL_free};
    bool is_trusted_ = false;
    std::string complaint_;
};

} // namespace scanloom::testing_support

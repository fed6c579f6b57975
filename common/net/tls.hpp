#pragma once

#include "common/error/error.hpp"

#include <boost/asio/ssl/context.hpp>

#include <memory>
#include <optional>
#include <string>

namespace scanloom::net {

using TlsContext = std::shared_ptr<boost::asio::ssl::context>;

/// The PEM files of the certificate that this side presents; it presents none if `certificate_file` is empty.
struct CertificateFiles {
    std::string certificate_file; ///< the certificate, then its intermediate certificates
    std::string key_file;         ///< its private key, without a password; empty: in certificate_file
};

/// Creates the TLS context of a client that verifies the server's certificate. Requires TLS 1.2 or later.
/// @param ca_file  PEM file of the trusted CA certificates; empty: those of the system
/// @param shown    the certificate for servers that request one
/// @return the context
/// Errors: kNotFound if a file cannot be read or does not hold a PEM certificate or key; kConflict if the key does not
///         belong to the certificate.
[[nodiscard]] Result<TlsContext> client_tls(const std::string& ca_file, const CertificateFiles& shown = {});

/// Creates the TLS context of a server. Requires TLS 1.2 or later.
///
/// All ciphers have forward secrecy: recorded connections cannot be decrypted with a private key that leaks later. Each
/// connection has exactly one full handshake: there are no session tickets and no renegotiation.
/// @param shown           the server's certificate
/// @param client_ca_file  PEM file of CA certificates: a client must present a certificate that one of them signed;
///                        empty: clients need no certificate
/// @return the context
/// Errors: those of client_tls(); kInvalidField if the permissions of the key file let its group write to it or let
///         other users access it.
[[nodiscard]] Result<TlsContext> server_tls(const CertificateFiles& shown, const std::string& client_ca_file = {});

/// Why a server rejects a client's certificate.
enum class ClientFault {
    kMissing, ///< the client presented none
    kForeign, ///< no trusted CA signed it, or it is not valid at this time
};

/// Returns why the client's certificate made a server's handshake fail; nullopt if it failed for another reason.
[[nodiscard]] std::optional<ClientFault> client_fault_of(const boost::system::error_code& failed) noexcept;

/// Returns whether a server's handshake failed because the client sent plain HTTP.
[[nodiscard]] bool is_plain_http(const boost::system::error_code& failed) noexcept;

/// Returns whether a server rejected the client because of its certificate, or because it presented none. With TLS 1.3
/// the client gets this error after its handshake, from its first read.
[[nodiscard]] bool is_refused_certificate(const boost::system::error_code& failed) noexcept;

/// Explains to people why a client's handshake failed and what to do.
/// @param failed         the error of the handshake
/// @param verify_result  LinkStream::verify_result()
/// @return one sentence
[[nodiscard]] std::string handshake_text(const boost::system::error_code& failed, long verify_result);

} // namespace scanloom::net

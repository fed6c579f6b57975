#pragma once

#include "common/error/error.hpp"

#include <boost/asio/ssl/context.hpp>

#include <memory>
#include <optional>
#include <string>

namespace scanloom::net {

using TlsContext = std::shared_ptr<boost::asio::ssl::context>;

/// A certificate that is shown, in PEM; none where `certificate_file` is empty.
struct CertificateFiles {
    std::string certificate_file; ///< the certificate, then those that lead to one that is trusted
    std::string key_file;         ///< its private key, without a password; empty: in the same file
};

/// For a client that checks whom it speaks to. TLS 1.2 at least.
/// @param ca_file  PEM, whose certificates are trusted; empty: those that the system trusts.
/// @param shown    to servers that want to know whom they speak to.
/// Errors  kNotFound: a file cannot be read, or is no such thing; kConflict: the key is another certificate's.
[[nodiscard]] Result<TlsContext> client_tls(const std::string& ca_file, const CertificateFiles& shown = {});

/// For a server. TLS 1.2 at least, with keys that are of no use to whoever gets hold of the server's later. Every
/// handshake is a whole one, and each connection has one: there are no tickets, and nobody may ask for another.
/// @param client_ca_file  PEM: clients must show a certificate that one of these signed; empty: they need none.
/// Errors  as client_tls(); kInvalidField: others than the owner of the key's file may write to it, or others than he
///         and its group may read it.
[[nodiscard]] Result<TlsContext> server_tls(const CertificateFiles& shown, const std::string& client_ca_file = {});

/// What is wrong with a client's certificate.
enum class ClientFault {
    kMissing, ///< it showed none
    kForeign, ///< nobody who is trusted signed it, or it is not valid now
};

/// Whether a server's handshake failed because of the client's certificate.
[[nodiscard]] std::optional<ClientFault> client_fault_of(const boost::system::error_code& failed) noexcept;

/// Whether a server's handshake failed because what arrived is plain HTTP.
[[nodiscard]] bool is_plain_http(const boost::system::error_code& failed) noexcept;

/// Whether a server has refused the certificate that a client showed, or that it showed none: of TLS 1.3 the client
/// hears that after its handshake, from the first reading.
[[nodiscard]] bool is_refused_certificate(const boost::system::error_code& failed) noexcept;

/// Why a client's handshake failed and what to do, for people.
/// @param verify_result  LinkStream::verify_result()
[[nodiscard]] std::string handshake_text(const boost::system::error_code& failed, long verify_result);

} // namespace scanloom::net

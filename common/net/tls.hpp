#pragma once

#include "common/error/error.hpp"

#include <boost/asio/ssl/context.hpp>

#include <memory>
#include <string>

namespace scanloom::net {

using TlsContext = std::shared_ptr<boost::asio::ssl::context>;

/// For a client that checks whom it speaks to. TLS 1.2 at least.
/// @param ca_file  PEM, whose certificates are trusted; empty: those that the system trusts.
/// Errors  kNotFound: the file cannot be read, or holds no certificate.
[[nodiscard]] Result<TlsContext> client_tls(const std::string& ca_file);

/// For a server. TLS 1.2 at least, with keys that are of no use to whoever gets hold of the server's later. Every
/// handshake is a whole one, and each connection has one: there are no tickets, and nobody may ask for another.
/// @param certificate_file  PEM: the server's certificate, then those that lead to a trusted one.
/// @param key_file          PEM: its private key, without a password.
/// Errors  kNotFound: a file cannot be read, or is no such thing; kConflict: the key is another certificate's.
[[nodiscard]] Result<TlsContext> server_tls(const std::string& certificate_file, const std::string& key_file);

/// Whether a server's handshake failed because what arrived is plain HTTP.
[[nodiscard]] bool is_plain_http(const boost::system::error_code& failed) noexcept;

/// Why a client's handshake failed and what to do, for people.
/// @param verify_result  LinkStream::verify_result()
[[nodiscard]] std::string handshake_text(const boost::system::error_code& failed, long verify_result);

} // namespace scanloom::net

#include "common/net/tls.hpp"

#include <boost/asio/ssl/error.hpp>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>

#include <filesystem>
#include <system_error>

namespace scanloom::net {

namespace ssl = boost::asio::ssl;

namespace {

TlsContext context_for(ssl::context::method method) {
    auto context = std::make_shared<ssl::context>(method);
    boost::system::error_code ignored; // these cannot fail
    context->set_options(ssl::context::default_workarounds | ssl::context::no_sslv2 | ssl::context::no_sslv3 |
                             ssl::context::no_tlsv1 | ssl::context::no_tlsv1_1,
                         ignored);
    return context;
}

Error unusable(const std::string& file, std::string_view what, const boost::system::error_code& failed) {
    return {Errc::kNotFound, fmt::format("{}: no {} in PEM can be read: {}", file, what, failed.message())};
}

const std::string& key_file_of(const CertificateFiles& files) {
    return files.key_file.empty() ? files.certificate_file : files.key_file;
}

Result<> show(ssl::context& context, const CertificateFiles& files) {
    if (files.certificate_file.empty()) return {};
    boost::system::error_code failed;
    context.use_certificate_chain_file(files.certificate_file, failed);
    if (failed) return unusable(files.certificate_file, "certificate", failed);
    context.set_password_callback([](std::size_t, ssl::context::password_purpose) { return std::string(); }, failed);
    const std::string& key_file = key_file_of(files);
    context.use_private_key_file(key_file, ssl::context::pem, failed);
    if (failed && ERR_GET_REASON(static_cast<unsigned long>(failed.value())) == X509_R_KEY_VALUES_MISMATCH) {
        return Error{Errc::kConflict,
                     fmt::format("{} is not the key of the certificate in {}", key_file, files.certificate_file)};
    }
    if (failed) return unusable(key_file, "private key without a password", failed);
    return {};
}

} // namespace

Result<TlsContext> client_tls(const std::string& ca_file, const CertificateFiles& shown) {
    auto context = context_for(ssl::context::tls_client);
    boost::system::error_code failed;
    if (ca_file.empty()) {
        context->set_default_verify_paths(failed);
    } else {
        context->load_verify_file(ca_file, failed);
    }
    if (failed) return unusable(ca_file.empty() ? "the system's certificates" : ca_file, "certificate", failed);
    context->set_verify_mode(ssl::verify_peer, failed);
    if (auto is_shown = show(*context, shown); !is_shown) return is_shown.error();
    return context;
}

namespace {

/// The ciphers for TLS 1.2. All ciphers of TLS 1.3 are acceptable.
constexpr const char* kCiphers = "ECDHE+AESGCM:ECDHE+CHACHA20";

/// Disables renegotiation, which costs the client that requests it much less than the server, and session tickets,
/// which would stay valid after the certificates are reloaded.
void harden(SSL_CTX* context) {
    SSL_CTX_set_options(context, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_TICKET | SSL_OP_NO_COMPRESSION |
                                     SSL_OP_CIPHER_SERVER_PREFERENCE | SSL_OP_PRIORITIZE_CHACHA);
    SSL_CTX_set_num_tickets(context, 0);
    SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
    SSL_CTX_set_mode(context, SSL_MODE_RELEASE_BUFFERS); // thousands of connections are idle most of the time
    SSL_CTX_set_cipher_list(context, kCiphers);
}

/// Checks who can read the key file, as every reader can impersonate the server. Its group may, as with Debian's
/// ssl-cert.
Result<> check_guarded(const std::string& key_file) {
    using std::filesystem::perms;
    std::error_code failed;
    const auto allowed = std::filesystem::status(key_file, failed).permissions();
    if (failed || (allowed & (perms::others_all | perms::group_write)) == perms::none) return {};
    return Error{Errc::kInvalidField,
                 fmt::format("{0}: this private key can be read by all users or changed by users other than its owner, "
                             "who can then impersonate the server; chmod g-w,o= {0}",
                             key_file)};
}

/// Requires client certificates. Clients also receive the names of the CAs, so that a browser with several certificates
/// offers those that these CAs signed.
Result<> ask_clients(ssl::context& context, const std::string& ca_file) {
    boost::system::error_code failed;
    context.load_verify_file(ca_file, failed);
    if (failed) return unusable(ca_file, "certificate", failed);
    SSL_CTX_set_client_CA_list(context.native_handle(), SSL_load_client_CA_file(ca_file.c_str()));
    context.set_verify_mode(ssl::verify_peer | ssl::verify_fail_if_no_peer_cert, failed);
    return {};
}

} // namespace

Result<TlsContext> server_tls(const CertificateFiles& shown, const std::string& client_ca_file) {
    auto context = context_for(ssl::context::tls_server);
    harden(context->native_handle());
    if (auto is_shown = show(*context, shown); !is_shown) return is_shown.error();
    if (auto guarded = check_guarded(key_file_of(shown)); !guarded) return guarded.error();
    if (client_ca_file.empty()) return context;
    if (auto asked = ask_clients(*context, client_ca_file); !asked) return asked.error();
    return context;
}

namespace {

/// Returns OpenSSL's reason for the error; 0 if it is not an error of OpenSSL.
int reason_of(const boost::system::error_code& failed) noexcept {
    if (failed.category() != boost::asio::error::get_ssl_category()) return 0;
    return ERR_GET_REASON(static_cast<unsigned long>(failed.value()));
}

std::string certificate_text(long verify_result) {
    switch (verify_result) {
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
        return "its certificate is for another name; give --server the name that is in it, or install a certificate "
               "for this name on the server";
    case X509_V_ERR_CERT_HAS_EXPIRED: return "its certificate has expired; install a new one on the server";
    case X509_V_ERR_CERT_NOT_YET_VALID: return "its certificate is not valid yet; check the clocks of both";
    default:
        return fmt::format("its certificate is not signed by a trusted certificate ({}); name the certificate that "
                           "signed it with --tls-ca",
                           X509_verify_cert_error_string(verify_result));
    }
}

} // namespace

std::optional<ClientFault> client_fault_of(const boost::system::error_code& failed) noexcept {
    const int reason = reason_of(failed);
    if (reason == SSL_R_PEER_DID_NOT_RETURN_A_CERTIFICATE) return ClientFault::kMissing;
    if (reason == SSL_R_CERTIFICATE_VERIFY_FAILED) return ClientFault::kForeign;
    return std::nullopt;
}

bool is_refused_certificate(const boost::system::error_code& failed) noexcept {
    switch (reason_of(failed)) {
    case SSL_R_TLSV13_ALERT_CERTIFICATE_REQUIRED:
    case SSL_R_TLSV1_ALERT_UNKNOWN_CA:
    case SSL_R_SSLV3_ALERT_BAD_CERTIFICATE:
    case SSL_R_SSLV3_ALERT_CERTIFICATE_EXPIRED:
    case SSL_R_SSLV3_ALERT_CERTIFICATE_UNKNOWN:
    case SSL_R_SSLV3_ALERT_UNSUPPORTED_CERTIFICATE: return true;
    default: return false;
    }
}

bool is_plain_http(const boost::system::error_code& failed) noexcept { return reason_of(failed) == SSL_R_HTTP_REQUEST; }

std::string handshake_text(const boost::system::error_code& failed, long verify_result) {
    const bool is_openssl = failed.category() == boost::asio::error::get_ssl_category();
    const int reason = reason_of(failed);
    if (reason == SSL_R_CERTIFICATE_VERIFY_FAILED) {
        return certificate_text(verify_result);
    }
    if (is_refused_certificate(failed)) {
        return fmt::format("the server accepts only clients with a certificate that it trusts ({}); name yours with "
                           "--tls-cert and --tls-key",
                           failed.message());
    }
    if (reason == SSL_R_WRONG_VERSION_NUMBER || reason == SSL_R_HTTP_REQUEST || !is_openssl) {
        return fmt::format(
            "the program there does not speak TLS ({}); leave --tls out, or install a certificate on the server",
            failed.message());
    }
    return failed.message();
}

} // namespace scanloom::net

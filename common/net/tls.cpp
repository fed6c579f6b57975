#include "common/net/tls.hpp"

#include <boost/asio/ssl/error.hpp>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>

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

} // namespace

Result<TlsContext> client_tls(const std::string& ca_file) {
    auto context = context_for(ssl::context::tls_client);
    boost::system::error_code failed;
    if (ca_file.empty()) {
        context->set_default_verify_paths(failed);
    } else {
        context->load_verify_file(ca_file, failed);
    }
    if (failed) return unusable(ca_file.empty() ? "the system's certificates" : ca_file, "certificate", failed);
    context->set_verify_mode(ssl::verify_peer, failed);
    return context;
}

Result<TlsContext> server_tls(const std::string& certificate_file, const std::string& key_file) {
    auto context = context_for(ssl::context::tls_server);
    boost::system::error_code failed;
    context->use_certificate_chain_file(certificate_file, failed);
    if (failed) return unusable(certificate_file, "certificate", failed);
    context->set_password_callback([](std::size_t, ssl::context::password_purpose) { return std::string(); }, failed);
    context->use_private_key_file(key_file, ssl::context::pem, failed);
    if (failed && ERR_GET_REASON(static_cast<unsigned long>(failed.value())) == X509_R_KEY_VALUES_MISMATCH) {
        return Error{Errc::kConflict,
                     fmt::format("{} is not the key of the certificate in {}", key_file, certificate_file)};
    }
    if (failed) return unusable(key_file, "private key without a password", failed);
    return context;
}

namespace {

std::string certificate_text(long verify_result) {
    switch (verify_result) {
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
        return "its certificate is for another name; give --server the name that is in it, or have the server given a "
               "certificate for this one";
    case X509_V_ERR_CERT_HAS_EXPIRED: return "its certificate has expired; have the server given a new one";
    case X509_V_ERR_CERT_NOT_YET_VALID: return "its certificate is not valid yet; check the clocks of both";
    default:
        return fmt::format("nobody who is trusted here signed its certificate ({}); name the certificate that signed "
                           "it with --tls-ca",
                           X509_verify_cert_error_string(verify_result));
    }
}

} // namespace

std::string handshake_text(const boost::system::error_code& failed, long verify_result) {
    const bool is_openssl = failed.category() == boost::asio::error::get_ssl_category();
    const int reason = is_openssl ? ERR_GET_REASON(static_cast<unsigned long>(failed.value())) : 0;
    if (reason == SSL_R_CERTIFICATE_VERIFY_FAILED) {
        return certificate_text(verify_result);
    }
    if (reason == SSL_R_WRONG_VERSION_NUMBER || reason == SSL_R_HTTP_REQUEST || !is_openssl) {
        return fmt::format("what listens there does not speak TLS ({}); leave --tls out, or have the server given a "
                           "certificate",
                           failed.message());
    }
    return failed.message();
}

} // namespace scanloom::net
